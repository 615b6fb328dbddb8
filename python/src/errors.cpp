#include <string>

#include "python/src/bindings.h"

namespace mica::python {
namespace {

const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "UsageError";
    case ErrorKind::device:
      return "DeviceError";
    case ErrorKind::file:
      return "FileError";
    case ErrorKind::cancelled:
      return "Cancelled";
  }
  return "Error";
}

/// The classes are Python's: each has a class of the standard library as a base besides.
void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("mica._errors").attr(class_of(error.kind()));
    const std::string text = error.what();  // a path in it may be of any bytes
    const nb::object message = nb::steal(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace"));
    PyErr_SetObject(type.ptr(), message.ptr());
  }
}

}  // namespace

void bind_errors(nb::module_& module) {
  nb::register_exception_translator(translate);
  nb::class_<CancellationToken>(module, "CancellationToken", "Tells work on another thread to stop.")
      .def(nb::init<>())
      .def("cancel", &CancellationToken::cancel);
}

}  // namespace mica::python
