// SPDX-License-Identifier: MIT
// The same rows in every format give the same bytes of state.dls. The files are written by NumPy,
// and what is only text by Python's own means.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/app/formats.hpp"

namespace dampline::app {
namespace {

class RowFormats : public FormatTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("simulate --duration 40 --seed 3 --quiet --out a.csv").code, 0);
    expected_ = state_of("a.csv");
    ASSERT_GT(expected_.size(), 10000U);
  }
  /// `names` and `rows` of a.csv stand before the script.
  [[nodiscard]] bool python(const std::string& script) const {
    return FormatTest::python(R"(
import csv
lines = list(csv.reader(open('a.csv')))
names, text = lines[0], lines[1:]
rows = [[float(c) for c in l] for l in text]
)" + script);
  }
  StateBytes expected_;
};

TEST_F(RowFormats, TextOfAnyLayout) {
  ASSERT_TRUE(python(R"(
def write(name, head, lines): open(name, 'w').write(head + ''.join(l + '\n' for l in lines))
write('blank.txt', '  '.join(names) + '\n', ['   '.join(l) for l in text])
write('bare.txt', '', ['\t'.join(l) for l in text])
write('preamble.csv', 'Export of a logger\nOperator;B\nRate [Hz];300;fixed\n\n' + ';'.join(names) + '\n',
      [';'.join(c.replace('.', ',') for c in l) for l in text])
order = [str(names.index(n) + 1) for n in names]
write('bare.toml', '[input.columns]\n', ['%s = "%s"' % (n, o) for n, o in zip(names, order)])
)"));
  EXPECT_EQ(state_of("-", "cat a.csv |"), expected_);
  EXPECT_EQ(state_of("- < a.csv"), expected_);
  EXPECT_EQ(state_of("blank.txt"), expected_);
  EXPECT_EQ(state_of("preamble.csv"), expected_);
  EXPECT_EQ(state_of("bare.txt --config bare.toml"), expected_);
}

TEST_F(RowFormats, DatesAreTimes) {
  ASSERT_TRUE(python(R"(
import datetime
begin = datetime.datetime(2024, 2, 29, 23, 59, 50, tzinfo=datetime.timezone.utc)
t = names.index('time_s')
def stamp(s): return (begin + datetime.timedelta(microseconds=round(1e6 * (s - rows[0][t])))).isoformat(timespec='microseconds')
def write(name, column):
    with open(name, 'w') as out:
        out.write(','.join(names) + '\n')
        for l, r in zip(text, rows): out.write(','.join(l[:t] + [column(r[t])] + l[t+1:]) + '\n')
write('dates.csv', stamp)
write('seconds.csv', lambda s: '%.6f' % (s - rows[0][t]))
)"));
  EXPECT_EQ(state_of("dates.csv"), state_of("seconds.csv"));
}

TEST_F(RowFormats, NumPy) {
  if (!python(R"(
import numpy as np
table = np.array(rows)
columns = {n: table[:, i] for i, n in enumerate(names)}
np.savez('a.npz', rate=300.0, name='truck 3', **columns)
np.savez_compressed('packed.npz', **columns)
record = np.zeros(len(rows), dtype=[(n, '<f8') for n in names])
for n in names: record[n] = columns[n]
np.save('record.npy', record)
np.save('rows.npy', table)
np.save('columns.npy', np.asfortranarray(table))
np.save('big.npy', table.astype('>f8'))
with open('bare.toml', 'w') as out:
    out.write('[input.columns]\n')
    for i, n in enumerate(names): out.write('%s = "%d"\n' % (n, i + 1))
)"))
    GTEST_SKIP() << "python3-numpy is not installed";
  EXPECT_EQ(state_of("a.npz"), expected_);
  EXPECT_EQ(state_of("packed.npz"), expected_);
  EXPECT_EQ(state_of("record.npy"), expected_);
  EXPECT_EQ(state_of("-", "cat record.npy |"), expected_);
  for (const char* file : {"rows.npy", "columns.npy", "big.npy"})
    EXPECT_EQ(state_of(std::string{file} + " --config bare.toml"), expected_) << file;
}

/// The last column has whole millionths, so that the table is written anew from what they are.
TEST_F(RowFormats, Mdf4OfMeasuredSignals) {
  ASSERT_TRUE(python(R"(
import sys
sys.path.insert(0, ')" DAMPLINE_SOURCE_DIR R"(/tests')
import mdf4
order = sorted(range(len(names)), key=lambda i: names[i] != 'time_s')
mixed = [[r[i] for i in order] for r in rows]
for r in mixed: r[-1] = round(1e6 * r[-1]) * 1e-6
for name, deflate, pieces in ('plain', None, None), ('packed', 'transposed', 5):
    mdf4.write_signals(name + '.mf4', [names[i] for i in order], mixed, deflate=deflate, pieces=pieces)
with open('mixed.csv', 'w') as out:
    out.write(','.join(names[i] for i in order) + chr(10))
    for r in mixed: out.write(','.join(map(repr, r)) + chr(10))
)")) << program_.read(".shell");
  const StateBytes state = state_of("mixed.csv");
  EXPECT_EQ(state_of("plain.mf4"), state);
  EXPECT_EQ(state_of("packed.mf4"), state);
  EXPECT_EQ(state_of("-", "cat packed.mf4 |"), state);
}

}  // namespace
}  // namespace dampline::app
