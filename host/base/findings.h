#pragma once

#include <string>
#include <vector>

namespace mica::host {

/// What reading or making something did that its user should know: assumptions, repairs, quantisation.
struct Findings {
  std::vector<std::string> notes;     ///< plain facts ("encoding unorm assumed from 8-bit pixels")
  std::vector<std::string> warnings;  ///< things that cost accuracy or changed the input
};

}  // namespace mica::host
