// SPDX-License-Identifier: MIT
#include "app/report/stage_report.hpp"

#include "app/report/page.hpp"
#include "app/text/warn.hpp"

namespace dampline::app {

void stage_report(const RunFiles& files, RunDirectory& directory) {
  const Page page =
      make_page(files.result, read_provenance(files.run_toml, "run.toml"), files.run_toml);
  if (!page.warning.empty()) warn(page.warning);
  directory.write("report.html", page.html);
}

}  // namespace dampline::app
