#include "mica/version.h"

MICA_BEGIN_NAMESPACE

const char* version() {
  return MICA_VERSION;
}

MICA_END_NAMESPACE
