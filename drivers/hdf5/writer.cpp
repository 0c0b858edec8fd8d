// SPDX-License-Identifier: MIT
#include <hdf5.h>

#include "drivers/hdf5/handle.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {

bool writes_hdf5() noexcept { return true; }

Outcome<bool> write_hdf5(const std::string& path, const ColumnTable& table) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what it would print is told by errors here
  const Failure cannot{Errc::kIo, "the HDF5 file cannot be written"};
  const Hdf5Handle file{H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, hdf5_access().id()),
                        H5Fclose};
  if (!file.ok()) return cannot;
  std::vector<double> values(static_cast<std::size_t>(table.rows));
  const hsize_t size = table.rows;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    table.fill(c, values);
    const Hdf5Handle space{H5Screate_simple(1, &size, nullptr), H5Sclose};
    const Hdf5Handle set{H5Dcreate2(file.id(), table.names[c].c_str(), H5T_IEEE_F64LE, space.id(),
                                    H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose};
    if (!set.ok() ||
        H5Dwrite(set.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      return cannot;
  }
  if (H5Fflush(file.id(), H5F_SCOPE_LOCAL) < 0) return cannot;
  return true;
}

}  // namespace dampline::drivers
