// SPDX-License-Identifier: MIT
#include "app/law/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/text/format.hpp"

namespace dampline::app::law {
namespace {

using Json = nlohmann::ordered_json;
using Part = Unknown::Part;

constexpr const char* kSchema = "dampline.law/1";
constexpr std::size_t kMostTerms = 256;
constexpr double kLeast = 1e-12;  // of a number that must stay above 0

constexpr std::array kTexts{
    TermText{Kind::kInertia, "inertia", "moving mass", "x''", "kg", "", ""},
    TermText{Kind::kOne, "constant", "offset_force", "", "N", "", ""},
    TermText{Kind::kDeflection, "deflection", "linear spring", "x", "N/m", "", ""},
    TermText{Kind::kSquare, "square", "quadratic_stiffness", "x^2", "N/m^2", "", ""},
    TermText{Kind::kCube, "cube", "cubic_stiffness", "x^3", "N/m^3", "", ""},
    TermText{Kind::kMagnitude, "magnitude", "asymmetric_stiffness", "|x|", "N/m", "", ""},
    TermText{Kind::kBumpUp, "bump_up", "bump_stop", "max(x - a, 0)", "N/m", "m", ""},
    TermText{Kind::kBumpDown, "bump_down", "bump_stop", "min(x + a, 0)", "N/m", "m", ""},
    TermText{Kind::kVelocity, "velocity", "viscous", "v", "N s/m", "", ""},
    TermText{Kind::kAcceleration, "acceleration", "moving mass", "x''", "kg", "", ""},
    TermText{Kind::kSpeed, "speed", "asymmetric_viscous", "|v|", "N s/m", "", ""},
    TermText{Kind::kSpeedSquared, "speed_squared", "quadratic_damping", "v |v|", "N s^2/m^2", "",
             ""},
    TermText{Kind::kSquareVelocity, "square_velocity", "progressive_damping", "x^2 v", "N s/m^3",
             "", ""},
    TermText{Kind::kSign, "sign", "coulomb", "tanh(v / a)", "N", "m/s", ""},
    TermText{Kind::kFading, "fading", "stribeck", "tanh(v / a) exp(-|v| / b)", "N", "m/s", "m/s"},
    TermText{Kind::kFadingSquare, "fading_square", "stribeck", "tanh(v / a) exp(-(v / b)^2)", "N",
             "m/s", "m/s"},
    TermText{Kind::kFadingSlowly, "fading_slowly", "stribeck", "tanh(v / a) / (1 + (v / b)^2)", "N",
             "m/s", "m/s"},
    TermText{Kind::kProgressive, "progressive", "progressive_friction", "tanh(v / a) x", "N/m",
             "m/s", ""},
    TermText{Kind::kProgressiveAbsolute, "progressive_absolute", "progressive_friction",
             "tanh(v / a) |x|", "N/m", "m/s", ""},
    TermText{Kind::kAttached, "attached", "unmodelled_mode",
             "acceleration of what hangs on x, of frequency a and damping ratio b", "kg", "Hz", ""},
    TermText{Kind::kBoucWen, "bouc_wen", "presliding_hysteresis",
             "z, z' = v - (|v| z + b v |z|) / a", "N/m", "m", ""},
    TermText{Kind::kMaxwell, "maxwell", "viscoelastic", "z, z' = v - z / a", "N/m", "s", ""},
    TermText{Kind::kStop, "stop", "presliding_hysteresis", "u", "N", "m", ""},
    TermText{Kind::kGapUp, "gap_up", "backlash", "max(u, 0)^4", "N", "m", ""},
    TermText{Kind::kGapDown, "gap_down", "backlash", "-max(-u, 0)^4", "N", "m", ""},
    TermText{Kind::kEdge, "edge", "presliding_hysteresis", "sign(u) max(0, 10 |u| - 9)", "N", "m",
             ""},
    TermText{Kind::kHat, "hat", "presliding_hysteresis", "max(0, 1 - |5 (u + 1) - b|)", "N", "m",
             ""},
    TermText{Kind::kFall, "fall", "presliding_hysteresis", "|v| min(max(2 b u - 1, 0), 1)", "N s/m",
             "m", ""},
    TermText{Kind::kBreakaway, "breakaway", "presliding_hysteresis",
             "|v| exp(-s / 0.01) where b u >= 1, s the way since", "N s/m", "m", ""}};

constexpr std::array<std::pair<Subject, const char*>, 3> kSubjects{
    {{Subject::kDrivenMass, "driven_mass"},
     {Subject::kDamper, "damper"},
     {Subject::kTruck, "truck"}}};
constexpr std::array<std::pair<Part, const char*>, 4> kParts{
    {{Part::kMass, "mass"}, {Part::kCoefficient, "coefficient"}, {Part::kA, "a"}, {Part::kB, "b"}}};

template <class T, std::size_t N>
const char* name_in(const std::array<std::pair<T, const char*>, N>& names, T value) {
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.first == value; })
      ->second;
}

template <class T, std::size_t N>
T value_in(const std::array<std::pair<T, const char*>, N>& names, const std::string& name,
           const std::string& place) {
  for (const auto& [value, text] : names)
    if (name == text) return value;
  throw RunError{fmt::format("{}: found \"{}\"", place, name)};
}

double part_of(const Law& law, const Unknown& u) {
  if (u.part == Part::kMass) return law.mass_kg;
  const Term& t = law.terms[u.terms.front()];
  return u.part == Part::kCoefficient ? t.coefficient
         : u.part == Part::kA         ? t.column.a
                                      : t.column.b;
}

const char* unit_of(const Law& law, const Unknown& u) {
  if (u.part == Part::kMass) return "kg";
  const TermText& text = text_of(law.terms[u.terms.front()].column.kind);
  return u.part == Part::kCoefficient ? text.unit : u.part == Part::kA ? text.unit_a : text.unit_b;
}

/// A function with its places named: of term 3 "tanh(v / a3)"; a sharp one "sign(v)".
std::string function_of(const Term& term, std::size_t number) {
  std::string text = text_of(term.column.kind).function;
  if (term.sharp && term.column.kind == Kind::kStop) return "sign(v)";
  if (const auto at = text.find("tanh(v / a)"); term.sharp && at != std::string::npos)
    text.replace(at, 11, "sign(v)");
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto is_letter = [&](std::size_t k) {
      return k < text.size() && std::isalpha(static_cast<unsigned char>(text[k])) != 0;
    };
    const bool alone = !is_letter(i + 1) && (i == 0 || !is_letter(i - 1));
    out += text[i];
    if (alone && (text[i] == 'a' || text[i] == 'b' || text[i] == 'u' || text[i] == 'z'))
      out += std::to_string(number);
  }
  return out;
}

Json numbers(const Eigen::VectorXd& values) {
  Json out = Json::array();
  for (const double v : values) out.push_back(v);
  return out;
}

Json term_json(const Document& d, std::size_t i) {
  const Term& t = d.law.terms[i];
  const TermText& text = text_of(t.column.kind);
  Json out{{"function", text.name},
           {"effect", text.effect},
           {"equation", function_of(t, i + 1)},
           {"coefficient", t.coefficient},
           {"unit", text.unit},
           {"a", t.column.a},
           {"a_unit", text.unit_a},
           {"b", t.column.b},
           {"b_unit", text.unit_b},
           {"sharp", t.sharp}};
  return out;
}

Json unknown_json(const Document& d, std::size_t i) {
  const Unknown& u = d.unknowns[i];
  Json out = parameter_json(u.name, {part_of(d.law, u), d.std_of(static_cast<Eigen::Index>(i))},
                            unit_of(d.law, u));
  out["part"] = name_in(kParts, u.part);
  out["terms"] = u.terms;
  return out;
}

Json initial_json(const Law& law, const State& initial) {
  const std::size_t count = memories_of(law).size();
  Json memory = Json::array();
  Json slip = Json::array();
  for (std::size_t m = 0; m < std::min(count, kMostMemories); ++m) {
    memory.push_back(initial.memory_m[m]);
    slip.push_back(initial.slip_m[m]);
  }
  return {{"deflection_m", initial.deflection_m},
          {"velocity_mps", initial.velocity_mps},
          {"memory_m", std::move(memory)},
          {"slip_m", std::move(slip)}};
}

Json covariance_json(const Eigen::MatrixXd& covariance) {
  Json out = Json::array();
  for (Eigen::Index r = 0; r < covariance.rows(); ++r)
    out.push_back(numbers(covariance.row(r).transpose()));
  return out;
}

Json unknowns_json(const Document& d) {
  Json out = Json::array();
  for (std::size_t i = 0; i < d.unknowns.size(); ++i) out.push_back(unknown_json(d, i));
  return out;
}

Json free_run_json(const Document& d) {
  if (!d.free_run) return nullptr;
  const Document moves = d.for_free_run();
  return {{"unknowns", unknowns_json(moves)},
          {"covariance", covariance_json(moves.covariance)},
          {"initial_state", initial_json(moves.law, moves.initial)},
          {"record_sha256", d.free_run->record_sha256},
          {"residual_m", moves.residual_m}};
}

Json known(double value) { return value > 0.0 ? Json(value) : Json(nullptr); }

/// Reads members, naming the one that is wrong.
class Reader {
 public:
  Reader(Json json, std::string place) : json_(std::move(json)), place_{std::move(place)} {}

  template <class T>
  [[nodiscard]] T get(const char* key) const {
    try {
      return json_.at(key).get<T>();
    } catch (const Json::exception&) {
      throw RunError{fmt::format("{}: {} is missing or of another kind", place_, key)};
    }
  }
  [[nodiscard]] double number(const char* key) const {
    const auto out = get<double>(key);
    if (!std::isfinite(out)) fail(fmt::format("{} is no number", key));
    return out;
  }
  [[nodiscard]] double number_or_0(const char* key) const {
    return get<Json>(key).is_null() ? 0.0 : number(key);
  }
  /// Of a member that files of earlier versions do not have.
  [[nodiscard]] double number_if_there(const char* key) const {
    return json_.contains(key) ? number_or_0(key) : 0.0;
  }
  /// It is there, and not null.
  [[nodiscard]] bool has(const char* key) const {
    return json_.contains(key) && !json_.at(key).is_null();
  }
  [[nodiscard]] Reader in(const char* key) const {
    return {get<Json>(key), fmt::format("{}: {}", place_, key)};
  }
  [[nodiscard]] std::vector<Reader> list(const char* key, std::size_t most) const {
    const Json all = get<Json>(key);
    if (!all.is_array() || all.size() > most)
      fail(fmt::format("{}: expected a list of at most {}", key, most));
    std::vector<Reader> out;
    for (std::size_t i = 0; i < all.size(); ++i)
      out.emplace_back(all[i], fmt::format("{}: {}[{}]", place_, key, i));
    return out;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw RunError{fmt::format("{}: {}", place_, what)};
  }
  [[nodiscard]] const std::string& place() const { return place_; }

 private:
  Json json_;
  std::string place_;
};

Term read_term(const Reader& from) {
  const auto function = from.get<std::string>("function");
  const auto* const text = std::find_if(kTexts.begin(), kTexts.end(),
                                        [&](const TermText& t) { return function == t.name; });
  if (text == kTexts.end()) from.fail(fmt::format("function: found \"{}\"", function));
  Term out{{text->kind, from.number("a"), from.number("b")},
           from.number("coefficient"),
           from.get<bool>("sharp")};
  const bool needs_a = text->unit_a[0] != '\0';
  const bool needs_b = text->unit_b[0] != '\0';
  if ((needs_a && !(out.column.a > 0.0)) || (needs_b && !(out.column.b > 0.0)))
    from.fail("a place that is not above 0");
  return out;
}

Unknown read_unknown(const Reader& from, std::size_t terms) {
  Unknown out{from.get<std::string>("name"),
              value_in(kParts, from.get<std::string>("part"), from.place() + ": part"),
              from.get<std::vector<std::size_t>>("terms")};
  const bool beyond =
      std::any_of(out.terms.begin(), out.terms.end(), [&](std::size_t t) { return t >= terms; });
  if (beyond || (out.part != Part::kMass && out.terms.empty()))
    from.fail("terms that are not there");
  return out;
}

/// Symmetric, no variance below 0.
Eigen::MatrixXd read_covariance(const Reader& from, std::size_t size) {
  const auto rows = from.get<std::vector<std::vector<double>>>("covariance");
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd out{n, n};
  bool fits = rows.size() == size;
  for (std::size_t r = 0; fits && r < size; ++r) {
    fits = rows[r].size() == size;
    for (std::size_t c = 0; fits && c < size; ++c)
      out(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c];
  }
  if (!fits) from.fail(fmt::format("covariance: expected {0} by {0} numbers", size));
  if (size > 0 &&
      (!out.allFinite() || out.diagonal().minCoeff() < 0.0 || !out.isApprox(out.transpose(), 1e-9)))
    from.fail("covariance: is none");
  return out;
}

State read_initial(const Reader& from) {
  State out{from.number("deflection_m"), from.number("velocity_mps")};
  const auto memory = from.get<std::vector<double>>("memory_m");
  const auto slip = from.get<std::vector<double>>("slip_m");
  if (memory.size() > kMostMemories || slip.size() != memory.size())
    from.fail(fmt::format("memory_m, slip_m: expected at most {}, alike", kMostMemories));
  std::copy(memory.begin(), memory.end(), out.memory_m.begin());
  std::copy(slip.begin(), slip.end(), out.slip_m.begin());
  return out;
}

/// Absent in files of earlier versions.
std::optional<FreeRunFigures> read_free_run(const Reader& all, const Document& law) {
  if (!all.has("free_run")) return std::nullopt;
  const Reader from = all.in("free_run");
  FreeRunFigures out;
  const std::vector<Reader> unknowns = from.list("unknowns", law.unknowns.size());
  if (unknowns.size() != law.unknowns.size()) from.fail("unknowns: expected those of the law");
  out.values.resize(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    out.values[static_cast<Eigen::Index>(i)] = unknowns[i].number("value");
  out.covariance = read_covariance(from, unknowns.size());
  out.initial = read_initial(from.in("initial_state"));
  out.record_sha256 = from.get<std::string>("record_sha256");
  out.residual_m = from.number("residual_m");
  return out;
}

}  // namespace

const TermText& text_of(Kind kind) noexcept {
  return *std::find_if(kTexts.begin(), kTexts.end(),
                       [&](const TermText& t) { return t.kind == kind; });
}

Eigen::VectorXd Document::values() const {
  Eigen::VectorXd out{static_cast<Eigen::Index>(unknowns.size())};
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = part_of(law, unknowns[i]);
  return out;
}

Law Document::with(const Eigen::VectorXd& values) const {
  Law out = law;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const Unknown& u = unknowns[i];
    const double value = values[static_cast<Eigen::Index>(i)];
    if (u.part == Part::kMass) out.mass_kg = std::max(value, kLeast);
    for (const std::size_t t : u.terms) {
      Term& term = out.terms[t];
      const bool shape = u.part == Part::kB && term.column.kind == Kind::kBoucWen;
      if (u.part == Part::kCoefficient) term.coefficient = value;
      if (u.part == Part::kA) term.column.a = std::max(value, kLeast);
      if (u.part == Part::kB) term.column.b = shape ? value : std::max(value, kLeast);
    }
  }
  return out;
}

Document Document::for_free_run() const {
  Document out = *this;
  if (!free_run) return out;
  out.law = with(free_run->values);
  out.covariance = free_run->covariance;
  out.initial = free_run->initial;
  out.residual_m = free_run->residual_m;
  out.free_run.reset();
  return out;
}

std::string Document::text_of(std::size_t i) const {
  return quantity_text(part_of(law, unknowns[i]), std_of(static_cast<Eigen::Index>(i)),
                       unit_of(law, unknowns[i]));
}

double Document::std_of(Eigen::Index i) const { return std::sqrt(std::max(covariance(i, i), 0.0)); }

std::string Document::equation() const {
  std::string out = law.mass_kg > 0.0 ? "m x''" : "";
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const std::string function = function_of(law.terms[i], i + 1);
    out += fmt::format("{}c{}{}{}", out.empty() ? "" : " + ", i + 1, function.empty() ? "" : " ",
                       function);
  }
  return out + (subject == Subject::kTruck ? " = -m (z1'' + z2''), x = 2 z - z1 - z2" : " = f");
}

std::string to_json(const Document& d) {
  Json terms = Json::array();
  for (std::size_t i = 0; i < d.law.terms.size(); ++i) terms.push_back(term_json(d, i));
  return json_text({{"schema", kSchema},
                    {"version", version()},
                    {"record", d.record},
                    {"subject", name_in(kSubjects, d.subject)},
                    {"equation", d.equation()},
                    {"mass_kg", known(d.law.mass_kg)},
                    {"terms", std::move(terms)},
                    {"unknowns", unknowns_json(d)},
                    {"covariance", covariance_json(d.covariance)},
                    {"initial_state", initial_json(d.law, d.initial)},
                    {"free_run", free_run_json(d)},
                    {"deflection_zero_m", d.zero_m},
                    {"force_sign", d.force_sign},
                    {"sample_rate_hz", d.sample_rate_hz},
                    {"filter_hz", known(d.filter_hz)},
                    {"residual",
                     {{"force_n", known(d.residual_n)},
                      {"deflection_m", known(d.residual_m)},
                      {"frame_accel_mps2", known(d.residual_mps2)},
                      {"lacking_n2_hz", known(d.lacking_n2_hz)}}},
                    {"not_in_it", d.not_in_it}});
}

Document read_document(std::string_view text, const std::string& origin) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    throw RunError{fmt::format("{}: is no JSON object", origin)};
  const Reader from{std::move(json), origin};
  if (const auto schema = from.get<std::string>("schema"); schema != kSchema)
    from.fail(fmt::format(R"(schema: found "{}", expected "{}")", schema, kSchema));
  Document out;
  out.record = from.get<std::string>("record");
  out.subject = value_in(kSubjects, from.get<std::string>("subject"), from.place() + ": subject");
  out.law.mass_kg = from.number_or_0("mass_kg");
  for (const Reader& term : from.list("terms", kMostTerms))
    out.law.terms.push_back(read_term(term));
  for (const Reader& unknown : from.list("unknowns", 3 * kMostTerms))
    out.unknowns.push_back(read_unknown(unknown, out.law.terms.size()));
  out.covariance = read_covariance(from, out.unknowns.size());
  out.initial = read_initial(from.in("initial_state"));
  out.free_run = read_free_run(from, out);
  out.zero_m = from.number("deflection_zero_m");
  out.force_sign = from.number("force_sign") < 0.0 ? -1.0 : 1.0;
  out.sample_rate_hz = from.number("sample_rate_hz");
  out.filter_hz = from.number_or_0("filter_hz");
  const Reader residual = from.in("residual");
  out.residual_n = residual.number_or_0("force_n");
  out.residual_m = residual.number_or_0("deflection_m");
  out.residual_mps2 = residual.number_or_0("frame_accel_mps2");
  out.lacking_n2_hz = residual.number_if_there("lacking_n2_hz");
  out.not_in_it = from.get<std::vector<std::string>>("not_in_it");
  return out;
}

}  // namespace dampline::app::law
