#pragma once

// All of Mica's public library.
#include "mica/brdf.h"       // IWYU pragma: export
#include "mica/control.h"    // IWYU pragma: export
#include "mica/device.h"     // IWYU pragma: export
#include "mica/error.h"      // IWYU pragma: export
#include "mica/evaluator.h"  // IWYU pragma: export
#include "mica/glints.h"     // IWYU pragma: export
#include "mica/job.h"        // IWYU pragma: export
#include "mica/method.h"     // IWYU pragma: export
#include "mica/query.h"      // IWYU pragma: export
#include "mica/settings.h"   // IWYU pragma: export
#include "mica/span.h"       // IWYU pragma: export
#include "mica/surface.h"    // IWYU pragma: export
#include "mica/version.h"    // IWYU pragma: export
