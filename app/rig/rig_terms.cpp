// SPDX-License-Identifier: MIT
#include "app/rig/rig_terms.hpp"

#include <fmt/format.h>

#include "app/error.hpp"

namespace dampline::app {
namespace {

void set(Branches& branches, Branches wanted, const char* what) {
  if (branches != Branches::kNone && branches != wanted)
    throw UsageError{
        fmt::format("[model] base: found both {0} and asymmetric_{0}, expected one of them", what)};
  branches = wanted;
}

void add_effect(const std::string& name, RigTerms& terms) {
  if (name == "viscous") {
    set(terms.viscous, Branches::kCommon, "viscous");
  } else if (name == "asymmetric_viscous") {
    set(terms.viscous, Branches::kSeparate, "viscous");
  } else if (name == "coulomb") {
    set(terms.coulomb, Branches::kCommon, "coulomb");
  } else if (name == "asymmetric_coulomb") {
    set(terms.coulomb, Branches::kSeparate, "coulomb");
  } else if (name == "offset_force") {
    terms.offset = true;
  } else {
    throw UsageError{fmt::format(
        "[model] base: found \"{}\", expected of a rig: viscous, asymmetric_viscous, coulomb, "
        "asymmetric_coulomb, offset_force",
        name)};
  }
}

}  // namespace

RigTerms rig_terms(const ModelConfig& model) {
  RigTerms terms;
  terms.coulomb = Branches::kNone;
  for (const std::string& name : model.base) add_effect(name, terms);
  terms.inertia = model.inertia == "identify";
  terms.stiffness = model.stiffness == "identify";
  if (!check(terms))
    throw UsageError{
        "[model] base: asymmetric_coulomb and offset_force cannot be told apart, expected one of "
        "them"};
  if (model.base.empty() && !terms.inertia && !terms.stiffness)
    throw UsageError{"[model] base: found no effect, expected at least one"};
  return terms;
}

std::vector<std::string> term_names(const RigTerms& terms) {
  std::vector<std::string> out;
  if (terms.inertia) out.emplace_back("moving mass");
  if (terms.stiffness) out.emplace_back("linear spring");
  if (terms.coulomb == Branches::kCommon) out.emplace_back("coulomb");
  if (terms.coulomb == Branches::kSeparate) out.emplace_back("asymmetric_coulomb");
  if (terms.viscous == Branches::kCommon) out.emplace_back("viscous");
  if (terms.viscous == Branches::kSeparate) out.emplace_back("asymmetric_viscous");
  if (terms.offset) out.emplace_back("offset_force");
  return out;
}

}  // namespace dampline::app
