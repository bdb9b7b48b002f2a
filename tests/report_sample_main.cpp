// report_sample FOLDER: writes the sample report, for the test in a browser and for those who change the page.

#include <iostream>

#include "report_sample.hpp"
#include "study/report_files.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "report_sample FOLDER\n";
    return 2;
  }
  const auto files = sweepgrid::study::write_report(sweepgrid::study::sample_report(160), argv[1]);
  std::cout << files.json.string() << '\n' << files.html.string() << '\n';
}
