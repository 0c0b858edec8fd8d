// SPDX-License-Identifier: MIT
#include "app/report/svg/panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/report/html.hpp"
#include "app/report/svg/scale.hpp"

namespace dampline::app::svg {
namespace {

constexpr double kWidth = 420.0;  // letters of 14 units are 12 pixels on a phone
constexpr double kLetter = 7.7;   // the mean letter
constexpr double kRow = 19.0;     // of the legend
constexpr double kSwatch = 24.0;
constexpr double kRight = 14.0;
constexpr double kLane = 42.0;
constexpr double kBarAt = 29.0;  // a lane's middle, below its name

std::string_view name_of(Ink ink) {
  constexpr std::array<std::string_view, 5> kNames{"blue", "orange", "green", "pink", "grey"};
  return kNames.at(static_cast<std::size_t>(ink));
}

double width_of(std::string_view text) {
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not the rest of a letter
  });
  return kLetter * static_cast<double>(letters);
}

std::string text_at(double x, double y, std::string_view text, std::string_view anchor = "") {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}"{}>{}</text>)", x, y,
                     anchor.empty() ? "" : fmt::format(" text-anchor=\"{}\"", anchor),
                     escape_html(text));
}

std::string dash(const Stroke& stroke) {
  return fmt::format(" stroke-width=\"{}\"{}", stroke.width,
                     stroke.dashed ? " stroke-dasharray=\"6 4\"" : "");
}

}  // namespace

struct Panel::Frame {
  struct Legend {
    double x{0.0};
    int row{0};
  };
  Scale x;
  Scale y;
  double left{0.0}, right{0.0}, top{0.0}, bottom{0.0};
  double height{0.0};  // of the drawing
  std::vector<Legend> legend{};
  std::vector<Tick> x_ticks{};
  std::vector<Tick> y_ticks{};
};

Panel::Panel(Axis x, Axis y, double height) : x_{std::move(x)}, y_{std::move(y)}, height_{height} {}

Panel::Panel(Axis x, std::vector<Lane> lanes)
    : x_{std::move(x)},
      y_{"", 0.0, 1.0, false, false},
      lanes_{std::move(lanes)},
      height_{kLane * static_cast<double>(lanes_.size())} {}

void Panel::line(std::vector<Point> points, const Stroke& stroke, std::string name) {
  marks_.push_back({Shape::kLine, std::move(points), stroke, 1.0, std::move(name)});
}

void Panel::band(const std::vector<Point>& lower, const std::vector<Point>& upper, Ink ink,
                 std::string name) {
  std::vector<Point> around{upper};
  around.insert(around.end(), lower.rbegin(), lower.rend());
  marks_.push_back({Shape::kArea, std::move(around), {ink}, 0.25, std::move(name)});
}

void Panel::boxes(const std::vector<Box>& boxes, Ink ink, double opacity, std::string name) {
  std::vector<Point> corners;
  for (const Box& b : boxes) corners.insert(corners.end(), {{b.left, b.bottom}, {b.right, b.top}});
  marks_.push_back({Shape::kBoxes, std::move(corners), {ink}, opacity, std::move(name)});
}

void Panel::dots(std::vector<Point> points, Ink ink, double radius, std::string name) {
  marks_.push_back({Shape::kDots, std::move(points), {ink, 2.0 * radius}, 1.0, std::move(name)});
}

void Panel::zone(double from, double to, std::string name) {
  zone_ = Mark{Shape::kBoxes, {{from, 0.0}, {to, 0.0}}, {Ink::kGrey}, 0.18, std::move(name)};
}

void Panel::flag(double x, double share, std::string name) {
  flags_.push_back({x, share, std::move(name)});
}

namespace {

/// With room above and below, where nobody said where it ends.
Scale scale_of(const Axis& axis, const std::vector<double>& data, double room) {
  const Scale tight{axis.log, axis.low, axis.high, data};
  if (room == 0.0 || axis.log) return tight;
  const double more = room * (tight.high() - tight.low());
  return {false,
          axis.low ? *axis.low : tight.low() - more,
          axis.high ? *axis.high : tight.high() + more,
          {}};
}

}  // namespace

Panel::Frame Panel::frame() const {
  std::vector<double> xs;
  std::vector<double> ys;
  for (const Mark& mark : marks_)
    for (const Point& p : mark.points) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
      xs.push_back(p.x);
      ys.push_back(p.y);
    }
  Frame f{scale_of(x_, xs, 0.0), scale_of(y_, ys, 0.05)};
  f.x_ticks = f.x.ticks();
  if (lanes_.empty()) f.y_ticks = f.y.ticks();
  double widest = 0.0;
  for (const Tick& tick : f.y_ticks) widest = std::max(widest, width_of(tick.text));
  f.left = lanes_.empty() ? widest + 36.0 : 8.0;
  f.right = kWidth - kRight;
  Frame::Legend next{f.left, 0};
  const auto take = [&](const Mark& mark) {
    const double width = kSwatch + width_of(mark.name) + 12.0;
    if (next.x > f.left && next.x + width > kWidth) next = {f.left, next.row + 1};
    if (!mark.name.empty()) f.legend.push_back(next);
    if (!mark.name.empty()) next.x += width;
  };
  for (const Mark& mark : marks_) take(mark);
  if (zone_) take(*zone_);
  f.top = 10.0 + (title_.empty() ? 0.0 : kRow) + (f.legend.empty() ? 0.0 : kRow * (next.row + 1));
  f.bottom = f.top + height_;
  f.height = f.bottom + (x_.numbers ? 22.0 : 8.0) + (x_.label.empty() ? 0.0 : 20.0);
  f.x.place(f.left, f.right);
  f.y.place(f.bottom, f.top);
  if (!lanes_.empty()) f.y.place(f.top + kBarAt, f.top + kBarAt + kLane);
  return f;
}

std::string Panel::legend(const Frame& frame) const {
  std::string out;
  std::size_t i = 0;
  const double first = 16.0 + (title_.empty() ? 0.0 : kRow);
  const auto add = [&](const Mark& mark) {
    if (mark.name.empty()) return;
    const Frame::Legend& place = frame.legend.at(i++);
    const double y = first + kRow * place.row;
    const bool drawn = mark.shape == Shape::kLine;
    out += fmt::format(R"(<path class="{}" d="M{:.1f} {:.1f}h18" stroke="currentColor")",
                       name_of(mark.stroke.ink), place.x, y - 5.0);
    out += drawn ? dash(mark.stroke)
                 : fmt::format(R"( stroke-width="{}" stroke-opacity="{}")",
                               mark.shape == Shape::kDots ? 5 : 10, mark.opacity);
    out += "/>" + text_at(place.x + kSwatch, y, mark.name);
  };
  for (const Mark& mark : marks_) add(mark);
  if (zone_) add(*zone_);
  return out;
}

std::string Panel::axes(const Frame& f) const {
  std::string grid;
  std::string texts;
  for (const Tick& tick : f.x_ticks) {
    grid += fmt::format("M{:.1f} {:.1f}V{:.1f}", f.x.at(tick.value), f.top, f.bottom);
    if (x_.numbers) texts += text_at(f.x.at(tick.value), f.bottom + 17.0, tick.text, "middle");
  }
  for (const Tick& tick : f.y_ticks) {
    grid += fmt::format("M{:.1f} {:.1f}H{:.1f}", f.left, f.y.at(tick.value), f.right);
    texts += text_at(f.left - 6.0, f.y.at(tick.value) + 5.0, tick.text, "end");
  }
  if (!x_.label.empty())
    texts += text_at(0.5 * (f.left + f.right), f.height - 4.0, x_.label, "middle");
  if (!y_.label.empty())
    texts += fmt::format(
        "<text transform=\"translate(13 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (f.top + f.bottom), escape_html(y_.label));
  if (!title_.empty()) texts += text_at(f.left, 16.0, title_);
  return fmt::format(
      R"(<path class="grid" d="{}"/><path class="axis" d="M{:.1f} {:.1f}V{:.1f}H{:.1f}"/>{})", grid,
      f.left, f.top, f.bottom, f.right, texts);
}

std::string Panel::lanes(const Frame& f) const {
  std::string out;
  double y = f.top + 15.0;
  for (const Lane& lane : lanes_) {
    out += text_at(f.left + 4.0, y, lane.name);
    if (!lane.note.empty()) out += text_at(f.right - 4.0, y, lane.note, "end");
    y += kLane;
  }
  return out;
}

std::string Panel::marks(const Frame& f) const {
  std::string out;
  if (zone_)
    out += fmt::format(
        "<rect class=\"grey\" x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" "
        "fill=\"currentColor\" fill-opacity=\"{4}\"/>",
        f.x.at(zone_->points[0].x), f.top, f.x.at(zone_->points[1].x) - f.x.at(zone_->points[0].x),
        height_, zone_->opacity);
  for (const Mark& mark : marks_) {
    const std::string path = mark.shape == Shape::kBoxes ? boxes_path(mark, f) : path_of(mark, f);
    if (path.empty()) continue;
    const bool filled = mark.shape == Shape::kArea || mark.shape == Shape::kBoxes;
    const std::string paint =
        filled ? fmt::format(R"(fill="currentColor" fill-opacity="{:.2f}")", mark.opacity)
               : fmt::format(R"(fill="none" stroke="currentColor"{}{})", dash(mark.stroke),
                             mark.shape == Shape::kDots ? " stroke-linecap=\"round\"" : "");
    out += fmt::format(R"(<path class="{}" {} d="{}"/>)", name_of(mark.stroke.ink), paint, path);
  }
  return out;
}

std::string Panel::path_of(const Mark& mark, const Frame& f) {
  std::string path;
  bool joined = false;
  for (const Point& p : mark.points) {
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y);
    if (finite)
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}{}", joined ? "L" : "M", f.x.at(p.x),
                     f.y.at(p.y), mark.shape == Shape::kDots ? "h0" : "");
    joined = finite && mark.shape != Shape::kDots;
  }
  return path;
}

/// A bar that is narrower than a line is drawn as wide as one.
std::string Panel::boxes_path(const Mark& mark, const Frame& f) {
  constexpr double kNarrowest = 0.8;
  std::string path;
  for (std::size_t i = 0; i + 1 < mark.points.size(); i += 2) {
    const Point& p = mark.points[i];
    const Point& q = mark.points[i + 1];
    if (!std::isfinite(p.x + p.y) || !std::isfinite(q.x + q.y)) continue;
    const double left = f.x.at(p.x);
    fmt::format_to(std::back_inserter(path), "M{0:.1f} {1:.1f}h{2:.1f}V{3:.1f}h-{2:.1f}z", left,
                   f.y.at(p.y), std::max(f.x.at(q.x) - left, kNarrowest), f.y.at(q.y));
  }
  return path;
}

std::string Panel::flags(const Frame& f) const {
  std::string out;
  for (const Flag& flag : flags_) {
    const double x = f.x.at(flag.x);
    const double y = f.bottom - flag.share * height_;
    const bool left = x + width_of(flag.name) + 8.0 > f.right;
    out += fmt::format(
        "<path class=\"orange\" stroke=\"currentColor\" stroke-width=\"1.5\" d=\"M{:.1f} "
        "{:.1f}V{:.1f}\"/>",
        x, f.bottom, y);
    out += text_at(left ? x - 5.0 : x + 5.0, y + 10.0, flag.name, left ? "end" : "start");
  }
  return out;
}

/// For who cannot see it: what is over what, the ranges, the names.
std::string Panel::alternative(const Frame& f, std::string_view what) const {
  std::string out{what};
  if (!title_.empty()) out += " " + title_ + ".";
  if (lanes_.empty()) {
    out += fmt::format(" {} from {:.4g} to {:.4g} over {} from {:.4g} to {:.4g}.", y_.label,
                       f.y.low(), f.y.high(), x_.label, f.x.low(), f.x.high());
  } else {
    out += fmt::format(" Rows over {} from {:.4g} to {:.4g}:", x_.label, f.x.low(), f.x.high());
    for (const Lane& lane : lanes_) out += " " + lane.name + ";";
  }
  std::string names;
  for (const Mark& mark : marks_)
    if (!mark.name.empty()) names += (names.empty() ? " Drawn: " : ", ") + mark.name;
  for (const Flag& flag : flags_) names += (names.empty() ? " Marked: " : ", ") + flag.name;
  return out + (names.empty() ? "" : names + ".");
}

std::string Panel::draw(const std::string& id, std::string_view what) const {
  const Frame f = frame();
  const std::string label =
      escape_html(lanes_.empty() ? fmt::format("{} over {}", y_.label, x_.label)
                  : what.empty() ? "Rows over " + x_.label
                                 : std::string{what});
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" id=\"{0}\" viewBox=\"0 0 "
             "{1} {2:.0f}\" role=\"img\" aria-label=\"{3}\" aria-describedby=\"{0}-desc\">"
             "<title>{3}</title><desc id=\"{0}-desc\">{4}</desc>"
             "<clipPath id=\"{0}-clip\"><rect x=\"{5:.1f}\" y=\"{6:.1f}\" width=\"{7:.1f}\" "
             "height=\"{8:.1f}\"/></clipPath>",
             escape_html(id), kWidth, f.height, label, escape_html(alternative(f, what)), f.left,
             f.top - 2.0, f.right - f.left + 2.0, height_ + 4.0) +
         axes(f) + fmt::format("<g clip-path=\"url(#{}-clip)\">", escape_html(id)) + marks(f) +
         "</g>" + flags(f) + lanes(f) + legend(f) + "</svg>";
}

namespace {

/// In quotes, safe in a script of a page.
std::string json_string(std::string_view text) {
  std::string out =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = out.find('<'); at != std::string::npos; at = out.find('<', at))
    out.replace(at, 1, "\\u003c");
  return out;
}

/// Numbers of an axis with as many digits as an enlarged plot can show.
class Digits {
 public:
  Digits(bool log, const Scale& scale) {
    constexpr double kShares = 2e5;  // of the range
    if (!log)
      decimals_ = static_cast<int>(std::ceil(std::log10(kShares / (scale.high() - scale.low()))));
  }
  void append(std::string& out, double value) const {
    if (out.back() != '[') out += ',';
    if (!std::isfinite(value)) {
      out += "null";
    } else if (decimals_ < 0 || decimals_ > kMostDecimals) {
      fmt::format_to(std::back_inserter(out), "{:.6g}", value);
    } else {
      fmt::format_to(std::back_inserter(out), "{:.{}f}", value, decimals_);
      if (decimals_ == 0) return;
      out.erase(out.find_last_not_of('0') + 1);
      if (out.back() == '.') out.pop_back();
    }
  }
  [[nodiscard]] std::string column(const std::vector<Point>& points, double Point::*of) const {
    std::string out = "[";
    for (const Point& p : points) append(out, p.*of);
    return out + ']';
  }

 private:
  static constexpr int kMostDecimals = 9;
  int decimals_{-1};
};

std::string axis_of(const Axis& axis, const Scale& scale) {
  return fmt::format(R"({{"label":{},"low":{:.8g},"high":{:.8g},"log":{}}})",
                     json_string(axis.label), scale.low(), scale.high(), axis.log);
}

}  // namespace

std::string Panel::points_of(const Mark& mark, const Frame& f,
                             std::vector<std::string>& places) const {
  const Digits x{x_.log, f.x};
  const Digits y{y_.log, f.y};
  if (mark.shape == Shape::kBoxes) {
    std::string corners = "[";
    for (const Point& p : mark.points) {
      x.append(corners, p.x);
      y.append(corners, p.y);
    }
    places.emplace_back();
    return fmt::format(R"("corners":{}])", corners);
  }
  // Around an area: the upper line, and the lower one back.
  const bool area = mark.shape == Shape::kArea;
  const std::size_t count = area ? mark.points.size() / 2 : mark.points.size();
  const auto end = mark.points.begin() + static_cast<std::ptrdiff_t>(count);
  const std::vector<Point> upper(mark.points.begin(), end);
  std::string place = x.column(upper, &Point::x);
  const auto same = std::find(places.begin(), places.end(), place);
  const std::string shown = same == places.end() ? place : fmt::format("{}", same - places.begin());
  places.push_back(std::move(place));
  const std::string values = y.column(upper, &Point::y);
  if (!area) return fmt::format(R"("x":{},"y":{})", shown, values);
  const std::vector<Point> lower(mark.points.rbegin(), std::make_reverse_iterator(end));
  return fmt::format(R"("x":{},"high":{},"low":{})", shown, values, y.column(lower, &Point::y));
}

std::string Panel::data() const {
  constexpr std::array<const char*, 4> kShapes{"line", "band", "boxes", "dots"};
  const Frame f = frame();
  const Digits x{x_.log, f.x};
  std::vector<std::string> places;
  std::string marks;
  for (const Mark& mark : marks_)
    marks += fmt::format(
        R"({}{{"shape":"{}","ink":"{}","width":{},"dashed":{},"opacity":{},"name":{},{}}})",
        marks.empty() ? "" : ",", kShapes.at(static_cast<std::size_t>(mark.shape)),
        name_of(mark.stroke.ink), mark.stroke.width, mark.stroke.dashed, mark.opacity,
        json_string(mark.name), points_of(mark, f, places));
  std::string lanes;
  for (const Lane& lane : lanes_)
    lanes += fmt::format("{}[{},{}]", lanes.empty() ? "" : ",", json_string(lane.name),
                         json_string(lane.note));
  std::string flags;
  for (const Flag& flag : flags_) {
    flags += flags.empty() ? "[" : ",[";
    x.append(flags, flag.x);
    fmt::format_to(std::back_inserter(flags), ",{:.3g},{}]", flag.share, json_string(flag.name));
  }
  std::string zone = zone_ ? "[" : "null";
  if (zone_) {
    x.append(zone, zone_->points[0].x);
    x.append(zone, zone_->points[1].x);
    fmt::format_to(std::back_inserter(zone), ",{}]", json_string(zone_->name));
  }
  return fmt::format(
      R"({{"title":{},"height":{},"x":{},"y":{},"zone":{},"lanes":[{}],"flags":[{}],"marks":[{}]}})",
      json_string(title_), height_, axis_of(x_, f.x), axis_of(y_, f.y), zone, lanes, flags, marks);
}

}  // namespace dampline::app::svg
