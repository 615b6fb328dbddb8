#pragma once

namespace mica::host::synthesis {

/// Throws UsageError unless `value` is in [low, high], which NaN is not. @param kind "scratches"; @param
/// setting "width in texels".
void check_setting(const char* kind, const char* setting, double value, double low, double high);

/// Throws UsageError unless a map of `resolution` texels a side can be made.
void check_resolution(const char* kind, int resolution);

}  // namespace mica::host::synthesis
