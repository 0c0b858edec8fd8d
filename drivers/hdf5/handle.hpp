// SPDX-License-Identifier: MIT
#pragma once
#include <hdf5.h>

#include <utility>

namespace dampline::drivers {

/// An identifier of the HDF5 library, closed as its kind is.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_{id}, close_{close} {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_{std::exchange(other.id_, -1)}, close_{other.close_} {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t id() const noexcept { return id_; }
  [[nodiscard]] bool ok() const noexcept { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// How files are opened: by stdio, which takes one without a name (/proc/self/fd), too.
[[nodiscard]] inline Hdf5Handle hdf5_access() {
  Hdf5Handle out{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  H5Pset_fapl_stdio(out.id());
  return out;
}

}  // namespace dampline::drivers
