// SPDX-License-Identifier: MIT
// By what a rig's diagnosis decides. Origins: firmware_core/docs/constants.md.
#pragma once
#include <array>
#include <cstddef>

namespace dampline::app::rig {

// A step is taken.
inline constexpr double kClearGain = 0.05;   // passes on its own
inline constexpr double kSmallGain = 0.025;  // passes with kSignificant
inline constexpr double kSignificant = 2.0;  // block t
inline constexpr double kLaterGain = 0.2;    // what the first leaves has many likenesses
inline constexpr double kLaterSignificant = 3.0;
inline constexpr double kBesideMemory = 0.5;  // gain of a step beside a memory
inline constexpr double kRest = 0.5;          // of the excess: what takes it needs only kClearGain
inline constexpr double kOfExcess = 0.1;  // what a step must take of what is left over the floor
inline constexpr double kMotionFloor =
    0.5;                              // how well the part of the floor is known that motion makes
inline constexpr double kSure = 4.0;  // significance that needs no excess over a noise floor
inline constexpr double kDriving = 5.0;  // deviations below zero: friction that drives
inline constexpr std::size_t kMostSteps = 4;
inline constexpr std::size_t kRunnersUp = 4;

// One of several is named.
inline constexpr double kAlike = 0.01;  // of what either leaves
inline constexpr double kAlikeMost = 0.1;
inline constexpr double kLinear =
    0.1;  // of what either leaves: a linear law goes before a curved one
inline constexpr double kPairGain = 0.2;  // of two together over the best and its companion
inline constexpr std::size_t kLookedAhead = 4;

// What is no column of the motion: lateness, drift, modes, impacts.
inline constexpr double kLeastGain = 0.1;
inline constexpr double kTrialSignificant = 3.0;
inline constexpr double kBetter = 0.85;    // of what the best column leaves
inline constexpr double kShortSkew = 1.0;  // samples: when within one a force changed is not known
inline constexpr double kClearlyLate = 0.5;  // gain of a lateness beside a memory
inline constexpr double kResolved = 0.03;    // derivatives over one and two samples differ by less
inline constexpr double kClearMemory = 0.2;  // gain from which a memory goes before impacts
inline constexpr double kMemoryToo = 0.5;    // of a trial's gain: a memory explains it too
inline constexpr double kOverFloor = 1.1;    // a mode has something to explain
inline constexpr double kStrokesDiffer = 0.1;  // spread of the force that like strokes make
inline constexpr double kInOrder = 0.8;  // scatter between neighbours, of it: a change over time
inline constexpr double kStepPlace = 0.029;  // of the record: a tenth, evenly spread

// Refined.
inline constexpr int kWidthRounds = 3;
inline constexpr double kWidestOfAll = 0.9;  // of the speed's rms
inline constexpr double kClearlyWider = 0.9;
inline constexpr double kBankRidge = 1e-2;
inline constexpr double kBankFrom = 0.4;  // travels that are tried, of the smallest form's
inline constexpr double kBankTo = 2.1;
inline constexpr double kBankStep = 1.15;
inline constexpr std::size_t kBankSpread = 3;  // steps between the three travels of a bank
inline constexpr double kSmoother = 0.8;       // of what the bank leaves
inline constexpr double kFrictionStays = 0.97;
inline constexpr double kUndecided = 1.6;  // between the errors of the smallest forms
inline constexpr double kPlay = 0.45;      // of the build-up: free play; a straight one has 0.28

// Pruned, and the base.
inline constexpr double kNeeded = 0.01;  // loss without it that keeps an effect or a linear term
inline constexpr double kDominantSpring = 0.5;  // of the base's error, that a spring takes
inline constexpr double kDominantMass = 0.5;    // of the error without an inertia, that it takes
inline constexpr double kByFar =
    0.1;  // of the error: an undeclared inertia explains that much more
inline constexpr double kBothNeeded = 0.9;      // of the error of friction or damping alone
inline constexpr double kWidestFriction = 0.3;  // of the speed's rms: wider, it is damping

// The verdict.
inline constexpr double kIncompleteAbove = 1.5;  // times the floor that noise makes
inline constexpr double kMotionAbove = 3.0;      // times what errors of the motion make
inline constexpr double kNegligible = 1e-5;      // nmse that no rig is held to
inline constexpr double kRichRidge = 1e-2;       // of all columns together
inline constexpr double kUntouched = 0.95;       // of what is left, by all columns: noise
inline constexpr double kStructured = 0.5;       // of what is left, by the state: no noise
inline constexpr double kImpossible = 2.0;  // deviations below zero: no mass, spring or friction

// Deviations.
inline constexpr int kJointRounds = 8;
inline constexpr double kArrived = 0.05;     // of a deviation: a place no longer moves
inline constexpr double kLongestMove = 0.2;  // of a place at once
inline constexpr double kHalvesApart = 3.0;  // deviations: halves differ, and the deviation widens

// The law by its own motion.
inline constexpr double kFollowed = 1.05;     // times the deflection's noise: nothing more is left
inline constexpr double kExact = 1e-8;        // nmse of the motion: the same
inline constexpr double kWhite = 1.2;         // times as dense as beside the motion: the same
inline constexpr double kSilentForce = 3e-4;  // of its rms: noise that moves nothing visibly
inline constexpr double kAsMuch = 0.33;       // of what noise of the force makes, or the other way
inline constexpr double kNearlyWhite = 1.5;   // the same, over a part of the records
inline constexpr std::array kSpeeds{1.0, 0.5, 2.0};  // of a friction that falls: starts
inline constexpr double kScreened = 60.0;  // periods of the motion, by which forms are compared
inline constexpr std::size_t kScreenedEffects = 5;  // of a step, the first
inline constexpr std::size_t kFormsOf = 2;   // effects that alone do not follow: in other forms
inline constexpr double kOtherToo = 4.0;     // times the least left: its other forms are tried
inline constexpr double kBaseLacks = 0.5;    // of what is left, by both of friction and damping
inline constexpr double kSameLeft = 10.0;    // of twice the log likelihood: no difference
inline constexpr double kSurelyLess = 20.0;  // of twice the log likelihood: an effect is there
inline constexpr double kLookedOn = 0.5;     // of the gain of what moves the mass: others might too
inline constexpr double kMisses = 1e-3;      // nmse of the motion: the law is not complete
inline constexpr double kOtherForm = 0.999;  // of the squares left: another form of an effect
inline constexpr double kShortly = 15.0;     // periods of the motion, which rule out other forms
inline constexpr double kRuledOut = 3e-7;    // as likely, over those
inline constexpr double kRuledOutLonger = 1e-26;  // the same, over kScreened
inline constexpr double kPlainer = 1.001;         // the same, for one with a figure less
inline constexpr double kMovesFarBetter = 0.1;    // the same, where more than noise is left
inline constexpr double kMovesBetter = 0.8;  // of the squares left: the motion's figures are better
inline constexpr double kOfTheirOwn =
    0.3;  // of what is left: the equations leave it of the law's own motion
inline constexpr int kCorrections = 4;
inline constexpr double kMostError = 0.5;   // of a figure and its deviation, by which equations err
inline constexpr double kCorrected = 0.3;   // deviations: no other correction
inline constexpr double kErrorStays = 0.5;  // of that, where it was taken off
inline constexpr double kAgree = 3.0;  // deviations of the difference between it and the equations

}  // namespace dampline::app::rig
