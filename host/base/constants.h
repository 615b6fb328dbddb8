#pragma once

namespace mica::host {

constexpr double kPi = 3.14159265358979323846;

}  // namespace mica::host
