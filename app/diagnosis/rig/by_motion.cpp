// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/by_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "app/diagnosis/rig/law.hpp"
#include "app/diagnosis/rig/own_motion.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/law/noise.hpp"
#include "app/law/shooting.hpp"
#include "app/law/start.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::uint64_t kNoiseSeed = 1931;  // of noise that is made

/// The records, or of each what holds so many periods of the motion.
std::vector<law::Drive> drives_of(const std::vector<Series>& records, double periods = 0.0) {
  std::vector<law::Drive> out;
  for (const Series& s : records) {
    Eigen::Index count = s.size();
    const double period_s = law::period_of(s.deflection_m, s.velocity_mps);
    if (periods > 0.0 && std::isfinite(period_s))
      count = std::min(
          count, static_cast<Eigen::Index>(periods * period_s /
                                           (s.interval_s * static_cast<double>(records.size()))));
    Eigen::VectorXd counts;
    if (s.left_out.size() == s.size())
      counts = (s.left_out.head(count).array() == 0.0).cast<double>();
    out.push_back({law::Input{s.force_n.head(count), s.interval_s}, s.deflection_m.head(count),
                   s.velocity_mps.head(count), counts});
  }
  return out;
}

/// Whether all figures of both lie within kAgree deviations of the difference.
bool agree(const Eigen::VectorXd& rows, const Eigen::MatrixXd& of_rows, const law::Shot& motion) {
  const Eigen::ArrayXd variance = of_rows.diagonal().array() + motion.covariance.diagonal().array();
  return ((rows - motion.unknowns).array().square() <= kAgree * kAgree * variance).all();
}

double log_size(const Eigen::MatrixXd& covariance) {
  return covariance.diagonal().array().max(1e-300).log().sum();
}

law::LawOf law_at(const Model& model, const Joint& joint, const Scale& scale) {
  std::vector<bool> sharp;
  for (const Regressor& c : model.columns) sharp.push_back(is_sharp(c, scale));
  return [&model, &joint, sharp](const Eigen::VectorXd& unknowns) {
    const Model there = with_unknowns(model, joint, unknowns);
    law::Law out;
    for (std::size_t i = 0; i < there.columns.size(); ++i) {
      const double value = unknowns[static_cast<Eigen::Index>(i)];
      if (is_inertia(there.columns[i].kind))
        out.mass_kg += value;
      else
        out.terms.push_back({there.columns[i], value, sharp[i]});
    }
    return out;
  };
}

/// A model, and where its own motion puts it.
struct Moved {
  Model model;  ///< as the equations have it
  Joint joint;
  law::Shot shot;
};

Moved move(const Model& model, const Joint& joint, const Eigen::VectorXd& start, const Scale& scale,
           const std::vector<law::Drive>& drives, law::Reach reach = law::Reach::kWhole) {
  Moved out{model, joint, {}};
  const Eigen::VectorXd rows = unknowns_of(model, joint);
  Eigen::VectorXd scales{rows.size()};
  std::vector<bool> positive;
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    scales[i] =
        std::max({std::abs(rows[i]), std::sqrt(std::max(joint.covariance(i, i), 0.0)), 1e-12});
    const auto at = static_cast<std::size_t>(i);
    if (at < joint.coefficients) {
      positive.push_back(is_inertia(model.columns[at].kind));
      continue;
    }
    const Place& place = joint.places[at - joint.coefficients];
    const bool shape =
        place.of == Place::Of::kB && model.columns[place.columns[0]].kind == Kind::kBoucWen;
    positive.push_back(!shape);
    if (shape) scales[i] = 1.0;
  }
  out.shot = law::shoot(law_at(model, joint, scale), start, scales, positive, drives, reach);
  return out;
}

/// No more is left than noise: by its place in the spectrum where that can be told, by its size
/// otherwise.
bool follows(const law::Shot& shot, double noise_m, double white = kWhite) {
  if (shot.nmse < kExact) return true;
  if (shot.density) return shot.density->ratio() < white;
  return shot.residual_m < kFollowed * noise_m;
}

/// Where it has come, the speeds at which friction falls that many times as high.
Eigen::VectorXd with_speeds(const Moved& moved, double times) {
  Eigen::VectorXd out = moved.shot.unknowns;
  for (std::size_t k = 0; k < moved.joint.places.size(); ++k) {
    const Place& place = moved.joint.places[k];
    if (place.of == Place::Of::kB && law::is_fading(moved.model.columns[place.columns[0]].kind))
      out[static_cast<Eigen::Index>(moved.joint.coefficients + k)] *= times;
  }
  return out;
}

std::vector<Kind> kinds_of(const Model& model) {
  std::vector<Kind> out;
  for (const Regressor& c : model.columns) out.push_back(c.kind);
  return out;
}

struct Form {
  Model model;
  bool plainer{false};  ///< than what the equations have
};

/// The model in other forms that the equations hardly tell apart where the motion is noisy:
/// friction without a width of its own, the other ways in which friction falls with speed, a memory
/// that yields smoothly. The plainer ones first.
std::vector<Form> other_forms(const Model& model, const Scale& scale) {
  std::vector<Form> starts{{model}};
  for (std::size_t i = 0; i < model.columns.size(); ++i) {
    if (!is_smooth(model.columns[i], scale)) continue;
    starts.push_back({model, true});
    starts.back().model.columns[i].a = scale.sign_mps;
  }
  std::vector<Form> out{starts.begin() + 1, starts.end()};
  std::rotate(starts.begin(), starts.begin() + 1, starts.end());
  for (const Form& start : starts)
    for (std::size_t i = 0; i < model.columns.size(); ++i) {
      const Regressor& c = start.model.columns[i];
      for (const Kind shape : law::kFadingForms) {
        if (!law::is_fading(c.kind) || c.kind == shape) continue;
        out.push_back(start);
        out.back().model.columns[i].kind = shape;
      }
      if (c.kind != Kind::kStop || !is_memory_travel(c.a, scale)) continue;
      out.push_back(start);
      out.back().model.columns[i] = {Kind::kBoucWen, 0.5 * c.a, 0.0};
    }
  return out;
}

double samples_of(const std::vector<law::Drive>& drives) {
  double out = 0.0;
  for (const law::Drive& d : drives) out += static_cast<double>(d.deflection_m.size());
  return out;
}

/// How many times as likely as another, where noise is white.
double as_likely(const law::Shot& shot, const law::Shot& other,
                 const std::vector<law::Drive>& drives) {
  return std::pow(other.nmse / shot.nmse, 0.5 * samples_of(drives));
}

/// What figures leave of the motion over segments so long; infinite where they run away.
double left_by(const Moved& moved, const Eigen::VectorXd& unknowns, double segment_s,
               const std::vector<law::Drive>& drives, const Scale& scale) {
  const law::Shot shot =
      law::follow(law_at(moved.model, moved.joint, scale), unknowns, drives, segment_s);
  return shot.ok ? shot.nmse : std::numeric_limits<double>::infinity();
}

void describe(const Moved& moved, const law::Shot& motion, const std::vector<law::Drive>& drives,
              const Scale& scale, FreeRunError& out) {
  out.segments = motion.segments;
  out.segment_s = motion.segment_s;
  out.nmse_of_motion = motion.held_out_nmse;
  out.residual_m = motion.residual_m;
  out.density_ratio.reset();
  if (motion.density) out.density_ratio = motion.density->ratio();
  out.nmse_of_equations =
      left_by(moved, unknowns_of(moved.model, moved.joint), motion.segment_s, drives, scale);
}

/// Which of both is kept.
void judge(Moved& moved, const std::vector<law::Drive>& drives, const Scale& scale,
           double noise_m) {
  const Eigen::VectorXd rows = unknowns_of(moved.model, moved.joint);
  const law::Shot& motion = moved.shot;
  FreeRunError& out = moved.model.free_run;
  describe(moved, motion, drives, scale, out);
  out.noise_m = noise_m;
  out.followed = follows(motion, noise_m);
  out.agree = agree(rows, moved.joint.covariance, motion);
  const double share = out.nmse_of_motion / out.nmse_of_equations;
  if (out.followed) {
    // The figures that leave clearly more than noise are the wrong ones.
    const double more = std::log(out.nmse_of_equations / motion.nmse) * samples_of(drives);
    const bool surer = log_size(motion.covariance) < log_size(moved.joint.covariance);
    out.by_motion = share < kMovesBetter || more > kSurelyLess || (out.agree && surer);
    return;
  }
  // A law that misses more than noise is held to its force, unless its motion is another one; over
  // short segments, since in long ones chaos parts the like too.
  const double short_s = motion.first_segment_s;
  out.by_motion = left_by(moved, motion.unknowns, short_s, drives, scale) <
                  kMovesFarBetter * left_by(moved, rows, short_s, drives, scale);
}

/// White noise of the records; empty where that of the force moves nothing visibly.
std::vector<law::Noise> noise_with_force(const std::vector<Series>& records) {
  std::vector<law::Noise> out;
  bool loud = false;
  for (const Series& s : records) {
    out.push_back({law::white_rms(s.force_n), s.noise_m});
    const double rms_n = std::sqrt((s.force_n.array() - s.force_n.mean()).square().mean());
    loud = loud || out.back().force_n > kSilentForce * rms_n;
  }
  if (!loud) out.clear();
  return out;
}

/// Where a law misses more than the deflection's noise, over short segments: what noise of the
/// force makes of its own motion, if that is of the same size.
std::optional<double> of_noise_alone(const Moved& briefly, const std::vector<law::Noise>& noise,
                                     const std::vector<law::Drive>& drives, const Scale& scale) {
  if (!briefly.shot.ok || !briefly.shot.density || noise.empty()) return std::nullopt;
  const law::Shot made = law::follow_own_noise(law_at(briefly.model, briefly.joint, scale),
                                               briefly.shot, drives, noise, kNoiseSeed);
  if (!made.density) return std::nullopt;
  const double times = briefly.shot.density->excess() / made.density->excess();
  if (!(times > kAsMuch && times < 1.0 / kAsMuch)) return std::nullopt;
  return made.density->ratio();
}

/// Where noise of the force is all that a law misses: its figures over short segments, which forget
/// what that has moved and in which chaos has not begun.
std::optional<law::Shot> shot_beside_noise(Moved& moved, const std::vector<Series>& records,
                                           const std::vector<law::Drive>& drives,
                                           const Scale& scale) {
  FreeRunError& out = moved.model.free_run;
  if (out.followed) return std::nullopt;
  const std::vector<law::Noise> noise = noise_with_force(records);
  if (noise.empty()) return std::nullopt;
  Moved briefly = move(moved.model, moved.joint, moved.shot.unknowns, scale, drives,
                       law::Reach::kFirstSegments);
  const std::optional<double> ratio = of_noise_alone(briefly, noise, drives, scale);
  if (!ratio) return std::nullopt;
  describe(moved, briefly.shot, drives, scale, out);
  out.density_ratio_of_noise = ratio;
  out.followed = true;
  return std::move(briefly.shot);
}

/// Over short segments of a part of the records, by which forms are compared.
Moved move_quickly(const Model& model, const Joint& joint, const Eigen::VectorXd& start,
                   const Scale& scale, const std::vector<law::Drive>& part) {
  return move(model, joint, start, scale, part, law::Reach::kTrial);
}

/// The form, and the figures, with which the best of all forms goes over a part of the records;
/// `first`, over it too, where no other goes clearly better.
Moved best_form(const Moved& first, const std::vector<Form>& forms, std::vector<Series>& records,
                const Scale& scale, const std::vector<law::Drive>& part, double noise_m) {
  if (!first.shot.ok || first.shot.nmse < kExact) return first;
  std::vector<Moved> starts{first};
  Moved best = first;
  bool plainer = false;  // the best
  const auto take = [&](Moved there, bool as_plainer) {
    if (!there.shot.ok) return;
    const double enough = as_plainer ? kPlainer : kOtherForm;
    // What misses more than noise makes unlike blocks, which only held out say what is better.
    const bool noise = follows(there.shot, noise_m, kNearlyWhite);
    const double left = noise ? there.shot.nmse : there.shot.held_out_nmse;
    if (!(left < enough * (noise ? best.shot.nmse : best.shot.held_out_nmse))) return;
    best = std::move(there);
    plainer = as_plainer;
  };
  for (const Form& form : forms) {
    if (plainer && !form.plainer && follows(best.shot, noise_m, kNearlyWhite)) continue;
    Model there = form.model;
    const Joint by_rows = fit_jointly(there, records, first.model.ridge, scale);
    if (!by_rows.ok) continue;
    starts.push_back(move_quickly(there, by_rows, unknowns_of(there, by_rows), scale, part));
    take(starts.back(), form.plainer);
    if (best.shot.nmse < kExact) return best;
  }
  // Sticking makes many minima: from where the best form has come, and with other speeds.
  const Moved from = best;
  for (const Moved& form : starts)
    for (const double times : kSpeeds) {
      const bool same = kinds_of(form.model) == kinds_of(from.model);
      if ((times != 1.0 && follows(best.shot, noise_m, kNearlyWhite)) ||
          form.joint.size() != from.joint.size() || same != (times != 1.0))
        continue;
      take(move_quickly(form.model, form.joint, with_speeds(from, times), scale, part), false);
    }
  return best;
}

/// A part of the records, and how likely a law must be over it.
struct Excerpt {
  std::vector<law::Drive> drives;
  double ruled_out;
  std::optional<law::Shot> best{};  ///< over it, as it is; once it was asked for
};

/// The model with another way in which friction falls with speed, moved over the whole; nothing
/// where a part of the records rules it out, or it does not move.
std::optional<Moved> in_other_form(const Moved& best, std::size_t column, Kind shape,
                                   const Scale& scale, std::vector<Excerpt>& excerpts,
                                   const std::vector<law::Drive>& drives) {
  Moved other = best;
  other.model.columns[column].kind = shape;
  for (Excerpt& part : excerpts) {
    other = move_quickly(other.model, other.joint, other.shot.unknowns, scale, part.drives);
    if (!other.shot.ok) return {};
    if (!part.best)
      part.best = law::follow(law_at(best.model, best.joint, scale), best.shot.unknowns,
                              part.drives, other.shot.segment_s);
    if (part.best->ok && as_likely(other.shot, *part.best, part.drives) < part.ruled_out) return {};
  }
  other = move(other.model, other.joint, other.shot.unknowns, scale, drives);
  if (!other.shot.ok) return {};
  return other;
}

/// What a part of a record leaves open in the ways in which friction falls with speed, the whole
/// one decides; and where it does not either, the others widen the deviations by what they are
/// likely (averaging over models; Hoeting, Madigan, Raftery and Volinsky, 1999). `best` has moved
/// over the whole.
Moved surest_of_fading(const Moved& best, const Scale& scale, const std::vector<Series>& records,
                       const std::vector<law::Drive>& drives) {
  const auto fading = std::find_if(best.model.columns.begin(), best.model.columns.end(),
                                   [](const Regressor& c) { return law::is_fading(c.kind); });
  if (fading == best.model.columns.end() || best.shot.nmse < kExact) return best;
  const auto column = static_cast<std::size_t>(fading - best.model.columns.begin());
  std::vector<Excerpt> excerpts{{drives_of(records, kShortly), kRuledOut},
                                {drives_of(records, kScreened), kRuledOutLonger}};
  std::vector<Moved> all{best};
  double segment_s = best.shot.segment_s;
  for (const Kind shape : law::kFadingForms) {
    if (shape == fading->kind) continue;
    auto other = in_other_form(best, column, shape, scale, excerpts, drives);
    if (!other) continue;
    segment_s = std::min(segment_s, other->shot.segment_s);
    all.push_back(std::move(*other));
  }
  if (all.size() == 1) return best;
  std::vector<law::Shot> seen;  // over segments of one length: longer ones leave more of any law
  for (const Moved& m : all)
    seen.push_back(
        law::follow(law_at(m.model, m.joint, scale), m.shot.unknowns, drives, segment_s));
  std::size_t first = 0;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (seen[i].ok && as_likely(seen[i], seen[first], drives) > 1.0) first = i;
  Moved out = all[first];
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == first || !seen[i].ok) continue;
    const double ratio = as_likely(seen[i], seen[first], drives);
    const Eigen::VectorXd apart = all[i].shot.unknowns - out.shot.unknowns;
    out.shot.covariance += ratio / (1.0 + ratio) * apart * apart.transpose();
  }
  return out;
}

bool can_move(const std::vector<Series>& records, const Model& model, const Scale& scale) {
  const std::optional<law::Law> law = law_of(model, scale);
  return law && law::FreeRun::is_seen(*law, records.front().interval_s) &&
         std::none_of(records.begin(), records.end(), [](const Series& s) { return s.has_gap; });
}

double noise_of(const std::vector<Series>& records) {
  double out = 0.0;
  for (const Series& s : records) out = std::max(out, s.noise_m);
  return out;
}

/// Where the equations' figures stay: those by which the records' whole motion is left less, held
/// out.
void keep_for_free_run(Moved& moved, std::size_t records) {
  FreeRunError& left = moved.model.free_run;
  const bool better = left.nmse_of_motion < kMovesBetter * left.nmse_of_equations;
  if (!better || moved.shot.segments != records) return;
  left.has_figures = true;
  const Eigen::VectorXd apart = moved.shot.unknowns - unknowns_of(moved.model, moved.joint);
  moved.model.for_free_run = {moved.shot.unknowns,
                              moved.shot.covariance + apart * apart.transpose(), moved.shot.start};
}

}  // namespace

bool is_force_noisy(const std::vector<Series>& records) {
  return !noise_with_force(records).empty();
}

Screened screen_by_motion(std::vector<Series> records, const Scale& scale, Model model,
                          double forms_below) {
  Screened out;
  if (!can_move(records, model, scale)) return out;
  const Joint joint = fit_jointly(model, records, model.ridge, scale);
  if (!joint.ok) return out;
  const double noise_m = noise_of(records);
  const std::vector<law::Drive> part = drives_of(records, kScreened);
  Moved moved = move_quickly(model, joint, unknowns_of(model, joint), scale, part);
  const std::vector<Form> forms = other_forms(model, scale);
  const bool all = moved.shot.ok && moved.shot.held_out_nmse < forms_below;
  if (all) moved = best_form(moved, forms, records, scale, part, noise_m);
  if (!moved.shot.ok) return out;
  out.ok = true;
  out.samples = samples_of(part);
  out.is_noise =
      follows(moved.shot, noise_m) || of_noise_alone(moved, noise_with_force(records), part, scale);
  out.followed = out.is_noise || follows(moved.shot, noise_m, kNearlyWhite);
  out.compared = all || forms.empty();
  out.nmse = moved.shot.held_out_nmse;
  out.model = with_unknowns(moved.model, moved.joint, moved.shot.unknowns);
  return out;
}

void refine_by_motion(std::vector<Series>& records, const Scale& scale, const Screened& screened,
                      Model& model, Joint& joint) {
  if (!joint.ok || !can_move(records, model, scale)) return;
  const std::vector<law::Drive> drives = drives_of(records);
  const double noise_m = noise_of(records);
  Moved best{model, joint, {}};
  Eigen::VectorXd start = unknowns_of(model, joint);
  if (screened.ok && screened.compared && kinds_of(screened.model) == kinds_of(model)) {
    Model there = model;
    there.columns = screened.model.columns;
    const Joint by_rows = fit_jointly(there, records, model.ridge, scale);
    if (by_rows.ok) {
      start = unknowns_of(screened.model, by_rows);
      best = {there, by_rows, {}};
    }
  } else if (const std::vector<Form> forms = other_forms(model, scale); !forms.empty()) {
    const std::vector<law::Drive> part = drives_of(records, kScreened);
    best = move_quickly(model, joint, start, scale, part);
    best = best_form(best, forms, records, scale, part, noise_m);
    start = best.shot.ok ? best.shot.unknowns : unknowns_of(best.model, best.joint);
  }
  best = move(best.model, best.joint, start, scale, drives);
  if (!best.shot.ok) best = move(model, joint, unknowns_of(model, joint), scale, drives);
  if (!best.shot.ok) return;
  if (follows(best.shot, noise_m, kNearlyWhite))
    best = surest_of_fading(best, scale, records, drives);
  judge(best, drives, scale, noise_m);
  if (!best.model.free_run.by_motion) keep_for_free_run(best, records.size());
  if (auto beside_noise = shot_beside_noise(best, records, drives, scale)) {
    best.model.free_run.by_motion =
        log_size(beside_noise->covariance) < log_size(best.joint.covariance);
    if (best.model.free_run.by_motion) best.shot = *std::move(beside_noise);
  }
  if (best.model.free_run.by_motion) {
    const Eigen::VectorXd apart = best.shot.unknowns - unknowns_of(best.model, best.joint);
    best.model = with_unknowns(std::move(best.model), best.joint, best.shot.unknowns);
    best.joint.covariance = best.shot.covariance;
    // It may have ended beside the least: as uncertain as both ways are apart.
    if (!best.model.free_run.followed) best.joint.covariance += apart * apart.transpose();
    best.joint.half_difference.setZero();
  } else {
    correct_by_own_motion(records, scale, best.model, best.joint);
  }
  model = std::move(best.model);
  joint = std::move(best.joint);
}

}  // namespace dampline::app::rig
