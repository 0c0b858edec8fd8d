// SPDX-License-Identifier: MIT
// What the pages of a fleet share.
#include <fmt/format.h>

#include "app/fleet/page/page.hpp"
#include "app/report/assets.hpp"
#include "app/report/html.hpp"
#include "app/text/format.hpp"

namespace dampline::app::fleet::page {
namespace {

/// Tables of many columns, whose short words stay whole.
constexpr std::string_view kWide = "body { max-width: 76rem; }";

/// As a value in an address.
std::string escape_address(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.' || c == '~';
    if (is_plain)
      out += c;
    else
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string head_of(Kind kind) {
  if (kind == Kind::kAlone) return fmt::format("{}<style>{}</style>", page_head(), kWide);
  return "<link rel=\"icon\" href=\"data:,\">\n<link rel=\"stylesheet\" href=\"/fleet.css\">\n";
}

std::string end_of(Kind kind) {
  return kind == Kind::kAlone
             ? page_scripts()
             : "<script src=\"/uplot.js\"></script>\n<script src=\"/plots.js\"></script>\n";
}

constexpr std::string_view kNavigation =
    "<nav aria-label=\"Fleet\"><a href=\"/\">Fleet</a> · <a href=\"/cars\">all cars</a> "
    "<form action=\"/car\" method=\"get\" role=\"search\"><label>Car "
    "<input name=\"vehicle\" required size=\"18\"></label> "
    "<button>Show</button></form></nav>\n";

}  // namespace

std::string framed(const std::string& title, const std::string& body, Kind kind) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>dampline: {0}</title>\n{1}</head><body>\n{2}<main>\n<h1>dampline: {0}</h1>\n{3}"
      "</main>\n{4}</body></html>\n",
      escape_html(title), head_of(kind), kind == Kind::kServed ? kNavigation : "", body,
      end_of(kind));
}

std::string car_link(const std::string& vehicle, Kind kind) {
  return kind == Kind::kServed ? "/car?vehicle=" + escape_address(vehicle) : "";
}

std::string vehicle_text(const std::string& vehicle) {
  return vehicle.empty() ? "(no name)" : vehicle;
}

std::string load_text(const Load& load) {
  const std::string mass = fmt::format("{:g} t", 1e-3 * load.moving_mass_kg);
  return load.name.empty() ? mass : fmt::format("{}, {}", load.name, mass);
}

std::string estimate_text(const std::optional<Estimate>& estimate, const std::string& unit) {
  return estimate ? quantity_text(estimate->value, estimate->std, unit) : "";
}

std::string outlier_table(const std::vector<Outlier>& outliers, Kind kind) {
  constexpr std::size_t kMost = 50;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> links;
  for (const Outlier& o : outliers) {
    if (rows.size() == kMost) break;
    rows.push_back({vehicle_text(o.vehicle), o.truck, load_text(o.load), o.quantity,
                    quantity_text(o.value.value, o.value.std, o.unit),
                    quantity_text(o.median, o.scatter, o.unit),
                    fmt::format("{:+.1f}", o.deviations), o.last_contact_utc});
    links.push_back(car_link(o.vehicle, kind));
  }
  return html_table(
      {"car", "truck", "load", "what", "value", "the fleet's", "deviations", "last contact (UTC)"},
      rows, 0, {}, links);
}

}  // namespace dampline::app::fleet::page
