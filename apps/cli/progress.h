#pragma once
#include <string>

namespace rubble::cli {

/// Shows the progress of a run on standard error: a bar on a terminal, a line every tenth of the run in a
/// log.
class Progress {
 public:
  /// `quiet` says nothing at all.
  /// `unit`: what is counted.
  Progress(std::string title, int steps, bool quiet, std::string unit = "step");
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// After `done` of them (counted from 1). `ms`: of the last step of the simulation.
  void update(int done, double ms);

 private:
  void drawBar(int done, double ms);
  void printLine(int done, double ms);

  std::string title_, unit_;
  int steps_;
  bool quiet_;
  bool terminal_;
  bool barIsOpen_ = false;
  double startTime_;
  double lastDrawn_ = 0;
  int tenthsPrinted_ = 0;
};

}  // namespace rubble::cli
