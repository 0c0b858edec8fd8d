// SPDX-License-Identifier: MIT
// The same rows in a MAT file that SciPy wrote give the same bytes of state.dls as the CSV file;
// so does one of Octave, where it is installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/app/formats.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

class Mat : public FormatTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("simulate --duration 40 --seed 3 --quiet --out a.csv").code, 0);
    if (!python(R"(
import csv, numpy as np
from scipy.io import savemat
lines = list(csv.reader(open('a.csv')))
names, table = lines[0], np.array([[float(c) for c in l] for l in lines[1:]])
columns = {n: table[:, i] for i, n in enumerate(names)}
savemat('six.mat', dict(columns, rate=300.0, vehicle='31 80'), oned_as='column')
savemat('seven.mat', columns, oned_as='row', do_compression=True)
savemat('deep.mat', {'data': dict(columns, remark='truck 3'), 'odd': np.array([1 + 2j, 3])}, do_compression=True)
savemat('table.mat', {'table': table})
savemat('text.mat', {'remark': 'no numbers'})
from array import array
open('columns.f8', 'wb').write(array('d', table.T.flatten()).tobytes())
columns = lambda form: '[input.columns]\n' + ''.join('%s = "%s"\n' % (n, form(i, n)) for i, n in enumerate(names))
open('deep.toml', 'w').write(columns(lambda i, n: 'data.' + n))
open('table.toml', 'w').write(columns(lambda i, n: 'table_%d' % (i + 1)))
)"))
      GTEST_SKIP() << "python3-scipy is not installed";
    if (DAMPLINE_HAS_MATIO == 0) {
      EXPECT_THAT(program_.run("identify six.mat").error, HasSubstr("built without"));
      const auto refused = program_.run("motion no_record.csv --out m.mat");
      EXPECT_EQ(refused.code, 2);
      EXPECT_THAT(refused.error, HasSubstr("libmatio-dev")) << "before the record is read";
      GTEST_SKIP() << "built without libmatio-dev";
    }
  }
};

TEST_F(Mat, GivesTheSameBytesAsTheTable) {
  const StateBytes expected = state_of("a.csv");
  ASSERT_GT(expected.size(), 10000U);
  EXPECT_EQ(state_of("six.mat"), expected);
  EXPECT_EQ(state_of("seven.mat"), expected) << "1 x N, deflated";
  EXPECT_EQ(state_of("deep.mat --config deep.toml"), expected) << "the fields of a structure";
  EXPECT_EQ(state_of("deep.mat"), expected) << "known by their names";
  EXPECT_EQ(state_of("table.mat --config table.toml"), expected);
  EXPECT_EQ(state_of("-", "cat seven.mat |"), expected);
  const std::string names = program_.read("a.csv").substr(0, program_.read("a.csv").find('\n'));
  std::string script = "f = fopen('columns.f8'); x = fread(f, Inf, 'double'); fclose(f);\n";
  std::string list;
  std::size_t begin = 0;
  int column = 0;
  const std::string count = std::to_string(std::count(names.begin(), names.end(), ',') + 1);
  while (begin <= names.size()) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    const std::string name = names.substr(begin, end - begin);
    script += name + " = reshape(x, [], " + count + ")(:, " + std::to_string(++column) + ");\n";
    list += " " + name;
    begin = end + 1;
  }
  program_.write("script.m", script + "save -v6 o6.mat" + list + "\nsave -v7 o7.mat" + list + "\n");
  static_cast<void>(shell("octave-cli -q script.m"));  // some ends with an error of its own
  if (program_.read("o7.mat").empty()) return;
  EXPECT_EQ(state_of("o6.mat"), expected);
  EXPECT_EQ(state_of("o7.mat"), expected);
}

TEST_F(Mat, ReadsNumbersOfEveryType) {
  ASSERT_TRUE(python(R"(
import csv, numpy as np
from scipy.io import savemat
lines = list(csv.reader(open('a.csv')))
names, table = lines[0], np.array([[float(c) for c in l] for l in lines[1:]])
whole = {n: np.clip(np.rint(20 * table[:, i]), -100, 100) for i, n in enumerate(names)}
for sign, shift, kinds in ('i', 0, 'f4 f8 i1 i2 i4 i8'), ('u', 100, 'u1 u2 u4 u8'):
    columns = {n: table[:, i] if 'time' in n else whole[n] + shift for i, n in enumerate(names)}
    with open(sign + '.csv', 'w') as out:
        out.write(','.join(names) + chr(10))
        for row in zip(*columns.values()): out.write(','.join(map(repr, map(float, row))) + chr(10))
    for kind in kinds.split():
        typed = {n: c if 'time' in n else c.astype(kind) for n, c in columns.items()}
        savemat(kind + '.mat', typed, oned_as='column')
)")) << program_.read(".shell");
  const StateBytes with_sign = state_of("i.csv");
  for (const char* file : {"f4.mat", "f8.mat", "i1.mat", "i2.mat", "i4.mat", "i8.mat"})
    EXPECT_EQ(state_of(file), with_sign) << file;
  const StateBytes without = state_of("u.csv");
  for (const char* file : {"u1.mat", "u2.mat", "u4.mat", "u8.mat"})
    EXPECT_EQ(state_of(file), without) << file;
}

TEST_F(Mat, NamesWhatItCannotUse) {
  EXPECT_THAT(program_.run("identify text.mat").error, HasSubstr("holds no array of numbers"));
  EXPECT_THAT(program_.run("identify table.mat").error, HasSubstr("table_1"));
}

TEST_F(Mat, CutOffOrDamagedItIsRefusedAndNoCrash) {
  for (const char* file : {"six.mat", "seven.mat", "deep.mat"}) {
    const std::string whole = program_.read(file);
    for (std::size_t i = 1; i < 10; ++i) {
      program_.write("cut.mat", whole.substr(0, i * whole.size() / 10));
      const auto outcome = program_.run("identify --quiet --no-report --force --out run cut.mat");
      EXPECT_EQ(outcome.code, 1);
      EXPECT_THAT(outcome.error, HasSubstr("cut.mat"));
    }
    for (std::size_t i = 0; i < 20; ++i) {
      std::string bytes = whole;
      for (std::size_t k = 0; k < 8; ++k) bytes[124 + (i * 97 + k * 13) % 1024] = '\xA5';
      program_.write("bad.mat", bytes);
      EXPECT_LE(program_.run("identify --quiet --no-report --force --out run bad.mat").code, 2)
          << i;
    }
  }
}

TEST_F(Mat, HoldsTheRowsOfMotion) {
  ASSERT_EQ(program_.run("motion a.csv --quiet --out m.npy").code, 0);
  const auto written = program_.run("motion a.csv --quiet --out m.mat");
  ASSERT_EQ(written.code, 0) << written.error;
  EXPECT_TRUE(python(R"(
import numpy as np
from scipy.io import loadmat
f = loadmat('m.mat')
read = lambda n: f[n][:, 0]
rows = np.load('m.npy')
assert len(rows) > 1000
for n in rows.dtype.names: assert np.array_equal(read(n), rows[n]), n
)")) << program_.read(".shell");
}

}  // namespace
}  // namespace dampline::app
