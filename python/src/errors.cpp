#include <filesystem>

#include "base/error.h"
#include "python/src/binding.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Cancelled& error) {
    PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetString(PyExc_OSError, (error.path1().string() + ": " + error.code().message()).c_str());
  }
}

PyObject* core_error(const char* name) { return nb::module_::import_("gonogo._core").attr(name).ptr(); }

void translate_to_core(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    PyErr_SetString(core_error("InputError"), error.what());
  } catch (const DeviceError& error) {
    PyErr_SetString(core_error("DeviceError"), error.what());
  }
}

}  // namespace

void raise_errors_of_core() {
  nb::register_exception_translator(translate);
  nb::register_exception_translator(translate_to_core);
}

void bind_errors(nb::module_& m) {
  const nb::exception<InputError> input(m, "InputError", PyExc_ValueError);
  nb::setattr(
      input, "__doc__",
      nb::str("What was given cannot be used. The sentence says file, place, value, allowed range and remedy."));
  const nb::exception<DeviceError> device(m, "DeviceError", PyExc_RuntimeError);
  nb::setattr(device, "__doc__",
              nb::str("A library, the operating system or a device refused. The sentence names the call."));
  nb::register_exception_translator(translate);
}

}  // namespace gonogo::python
