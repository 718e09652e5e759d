// Elementary functions with the same bits on every CPU, compiler and optimisation level.
//
// What computes a run calls these and never the C library's: glibc picks another implementation on
// CPUs with FMA, and results change in the last bit. Behind them stand SLEEF's scalar functions
// (error ≤ 1 ulp). Of the C library only sqrt, floor, ceil, trunc, fabs, ldexp are safe.
#pragma once

namespace hearsay::math {

inline constexpr double pi = 3.14159265358979323846;

double exp(double x);
double expm1(double x);
double log(double x);
double log1p(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double tanh(double x);
/// √(x² + y²) without overflow.
double hypot(double x, double y);
/// log |Γ(x)|.
double lgamma(double x);
/// ψ(x) = d/dx log Γ(x), x > 0; relative error below 1e-13 (recurrence and asymptotic series).
double digamma(double x);
/// The angle brought to (−π, π].
double wrap_angle(double angle_rad);

}  // namespace hearsay::math
