// SPDX-License-Identifier: MIT
// The same rows in an HDF5 file that h5py wrote give the same bytes of state.dls as the CSV file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/app/formats.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

class Hdf5 : public FormatTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("simulate --duration 40 --seed 3 --quiet --out a.csv").code, 0);
    if (!python(R"(
import csv, h5py, numpy as np
lines = list(csv.reader(open('a.csv')))
names, table = lines[0], np.array([[float(c) for c in l] for l in lines[1:]])
with h5py.File('a.h5', 'w') as f:
    for i, n in enumerate(names): f[n] = table[:, i]
    f['rate'] = 300.0
    f['vehicle'] = '31 80'
with h5py.File('deep.h5', 'w') as f:
    for i, n in enumerate(names): f.create_dataset('run/' + n, data=table[:, i], chunks=(1000,), compression='gzip')
with h5py.File('matlab.h5', 'w', userblock_size=512) as f:
    for i, n in enumerate(names): f[n] = table[:, i].reshape(1, -1)
bytes_ = bytearray(open('matlab.h5', 'rb').read())
bytes_[:19] = b'MATLAB 7.3 MAT-file'
open('matlab.mat', 'wb').write(bytes_)
with h5py.File('table.h5', 'w') as f: f['table'] = table
columns = lambda form: '[input.columns]\n' + ''.join('%s = "%s"\n' % (n, form(i, n)) for i, n in enumerate(names))
open('deep.toml', 'w').write(columns(lambda i, n: 'run/' + n))
open('table.toml', 'w').write(columns(lambda i, n: 'table_%d' % (i + 1)))
)"))
      GTEST_SKIP() << "python3-h5py is not installed";
    if (DAMPLINE_HAS_HDF5 == 0) {
      EXPECT_THAT(program_.run("identify a.h5").error, HasSubstr("built without"));
      const auto refused = program_.run("motion no_record.csv --out m.h5");
      EXPECT_EQ(refused.code, 2);
      EXPECT_THAT(refused.error, HasSubstr("libhdf5-dev")) << "before the record is read";
      GTEST_SKIP() << "built without libhdf5-dev";
    }
  }
};

TEST_F(Hdf5, GivesTheSameBytesAsTheTable) {
  const StateBytes expected = state_of("a.csv");
  ASSERT_GT(expected.size(), 10000U);
  EXPECT_EQ(state_of("a.h5"), expected);
  EXPECT_EQ(state_of("deep.h5 --config deep.toml"), expected) << "in a group, in deflated pieces";
  EXPECT_EQ(state_of("matlab.mat"), expected) << "1 x N, behind MATLAB's block";
  EXPECT_EQ(state_of("table.h5 --config table.toml"), expected);
  EXPECT_EQ(state_of("-", "cat a.h5 |"), expected);
}

TEST_F(Hdf5, CutOffAnywhereItIsRefusedOrReadAsFarAsItGoes) {
  const std::string whole = program_.read("a.h5");
  for (std::size_t i = 1; i < 12; ++i) {
    program_.write("cut.h5", whole.substr(0, i * whole.size() / 12));
    const auto outcome = program_.run("identify --quiet --no-report --force --out run cut.h5");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("cut.h5"));
  }
}

TEST_F(Hdf5, DamageIsNoCrash) {
  const std::string whole = program_.read("a.h5");
  for (std::size_t i = 0; i < 40; ++i) {
    std::string bytes = whole;
    for (std::size_t k = 0; k < 8; ++k) bytes[(i * 97 + k * 13) % 4096] = '\xA5';
    program_.write("bad.h5", bytes);
    EXPECT_LE(program_.run("identify --quiet --no-report --force --out run bad.h5").code, 2) << i;
  }
}

TEST_F(Hdf5, HoldsTheRowsOfMotion) {
  ASSERT_EQ(program_.run("motion a.csv --quiet --out m.npy").code, 0);
  const auto written = program_.run("motion a.csv --quiet --out m.h5");
  ASSERT_EQ(written.code, 0) << written.error;
  EXPECT_TRUE(python(R"(
import numpy as np
import h5py
f = h5py.File('m.h5')
read = lambda n: f[n][:]
rows = np.load('m.npy')
assert len(rows) > 1000
for n in rows.dtype.names: assert np.array_equal(read(n), rows[n]), n
)")) << program_.read(".shell");
}

}  // namespace
}  // namespace dampline::app
