#pragma once

namespace mica::host {

// Smith's masking and shadowing for Beckmann-distributed slopes, after [Heitz14]: Eric Heitz, "Understanding
// the Masking-Shadowing Function in Microfacet-Based BRDFs", Journal of Computer Graphics Techniques 3(2),
// 2014.

/// Lambda(omega), [Heitz14] Eq. 66. @param cos_theta (0, 1]; @param alpha Beckmann roughness, >= 0.
double beckmann_lambda(double cos_theta, double alpha);

/// Height-correlated masking and shadowing G2(o, i), [Heitz14] Eq. 99. @return [0, 1].
double smith_masking_shadowing(double cos_o, double cos_i, double alpha);

}  // namespace mica::host
