#include "apps/cli/text_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/statistics.h"

namespace rubble::cli {
namespace {

using Out = std::back_insert_iterator<std::string>;

void heading(Out out, const io::RunRecord& record) {
  fmt::format_to(out, "{}\n", record.scene);
  fmt::format_to(out, "  {} on {}, {} thread{}, {}{} iterations, dt {:.6g} s\n", record.backend,
                 record.device, record.threads, record.threads == 1 ? "" : "s",
                 record.substeps == 1 ? "" : fmt::format("{} substeps of ", record.substeps),
                 record.iterations, record.dt);
  fmt::format_to(out, "  {} bodies, {} manifolds, {} contact points, {} colors, {} clashes\n\n",
                 record.bodies, record.manifolds, record.contacts, record.colors, record.clashes);
}

void timeRow(Out out, const std::string& name, const io::PhaseTimes& t) {
  fmt::format_to(out, "  {:<24}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}\n", name, t.mean, t.median, t.p95, t.max);
}

void times(Out out, const io::RunRecord& record, const std::vector<StepReport>& reports) {
  const StepRange all{0, static_cast<int>(reports.size())};
  std::vector<double> totals;
  totals.reserve(reports.size());
  for (const StepReport& report : reports) totals.push_back(report.totalMs);
  fmt::format_to(out, "  {:<24}{:>10}{:>10}{:>10}{:>10}\n", "time [ms]", "mean", "median", "95 %", "max");
  // Stages that have nothing to do in this scene are left out.
  constexpr double kNothing = .0005;
  for (const auto& [name, t] : stageTimes(reports, all))
    if (t.mean >= kNothing) timeRow(out, name, t);
  timeRow(out, fmt::format("step, all {}", reports.size()), summarize(std::move(totals)));
  if (record.settled) timeRow(out, "step, settled", *record.settled);
  if (record.smash) timeRow(out, "step, smash", *record.smash);
  if (!record.stages.empty())
    fmt::format_to(out, "  settled: collision {:.3f}, solve {:.3f}\n", record.collisionMs, record.solveMs);
  fmt::format_to(out, "\n");
}

void ranks(Out out, const io::RunRecord& record) {
  if (record.ranks.empty()) return;
  fmt::format_to(out, "  {:<8}{:>12}{:>15}{:>12}{:>10}{:>10}{:>10}{:>10}\n", "rank", "own [ms]",
                 "exchange [ms]", "kB sent", "messages", "bodies", "ghosts", "rows");
  for (std::size_t r = 0; r < record.ranks.size(); ++r) {
    const RankReport& own = record.ranks[r];
    fmt::format_to(out, "  {:<8}{:>12.3f}{:>15.3f}{:>12.1f}{:>10}{:>10}{:>10}{:>10}\n", r, own.ownMs,
                   own.exchangeMs, static_cast<double>(own.bytes) / 1e3, own.messages, own.bodies, own.ghosts,
                   own.rows);
  }
  fmt::format_to(out, "  imbalance {:.1f} %\n\n", 100 * imbalanceOf(record.ranks));
}

void quality(Out out, const io::RunRecord& record) {
  if (record.penetration)
    fmt::format_to(out, "  penetration             mean {}, 99 % {}, max {}\n",
                   lengthText(record.penetration->mean), lengthText(record.penetration->p99),
                   lengthText(record.penetration->max));
  if (record.jointGapMean)
    fmt::format_to(out, "  joint error             mean {}, max {}\n", lengthText(*record.jointGapMean),
                   lengthText(record.jointGapMax.value_or(0)));
  if (record.topDrop) fmt::format_to(out, "  top level down          {}\n", lengthText(*record.topDrop));
  fmt::format_to(out, "  energy                  {:.6g} J\n", record.energy);
  fmt::format_to(out, "  tables of the engine    {:.1f} MB, {:.0f} bytes a body settled\n", record.engineMb,
                 record.bytesPerBody);
  fmt::format_to(out, "  resident memory         {:.1f} MB\n", record.rssMb);
  if (!record.hash.empty()) fmt::format_to(out, "  hash of the state       {}\n", record.hash);
}

/// The residual that iterations leave, step by step.
void residuals(Out out, const std::vector<StepReport>& reports) {
  double sum = 0, most = 0;
  for (const StepReport& r : reports) sum += r.unfinishedMotion, most = std::max(most, r.unfinishedMotion);
  if (most > 0)
    fmt::format_to(out, "  unfinished motion       mean {:.2g}, max {:.2g} lengths of a body\n",
                   sum / static_cast<double>(reports.size()), most);
}

/// Notices of the step reports beyond counts.
void notices(Out out, const std::vector<StepReport>& reports) {
  long broken = 0, spin = 0, restarts = 0, clashes = 0, failed = 0;
  int quarantined = 0;
  std::map<std::string, int> grown;
  for (const StepReport& r : reports) {
    for (const Growth& growth : r.grown) ++grown[growth.what];
    failed += r.failedSolves, broken += r.brokenJoints, spin += r.spinLimited, restarts += r.restarts,
        clashes += r.clashes;
    quarantined = std::max(quarantined, r.quarantined);
  }
  if (broken) fmt::format_to(out, "  notice: {} joints broke\n", broken);
  if (spin) fmt::format_to(out, "  notice: the spin of a body was limited {} times\n", spin);
  if (restarts) {
    std::vector<std::string> kinds;
    for (const auto& [kind, times] : grown) kinds.push_back(fmt::format("{} {}", kind, times));
    fmt::format_to(out, "  notice: {} steps were begun again with more room ({})\n", restarts,
                   fmt::join(kinds, ", "));
  }
  if (clashes) fmt::format_to(out, "  notice: {} pairs of neighbors were solved with one color\n", clashes);
  if (failed)
    fmt::format_to(out, "  notice: {} local problems were left unsolved for an iteration\n", failed);
  if (quarantined)
    fmt::format_to(out, "  notice: {} bodies were frozen because their state was not finite\n", quarantined);
}

std::string bounds(const io::ClaimRecord& claim) {
  if (std::isinf(claim.min)) return fmt::format("<= {:.6g}", claim.max);
  if (std::isinf(claim.max)) return fmt::format(">= {:.6g}", claim.min);
  return fmt::format("{:.6g} .. {:.6g}", claim.min, claim.max);
}

void verdict(Out out, const io::RunRecord& record) {
  if (record.claims.empty()) {
    fmt::format_to(out, "\nverdict: the scene makes no claim\n");
    return;
  }
  fmt::format_to(out, "\nverdict: {}\n", record.holds ? "holds" : "does not hold");
  if (!record.statedFor.empty()) fmt::format_to(out, "  (it is stated for {})\n", record.statedFor);
  for (const io::ClaimRecord& claim : record.claims) {
    fmt::format_to(out, "  {:<4} {:<28}{:>14}   wanted {:<22} {}\n", claim.holds ? "yes" : "NO", claim.metric,
                   std::isnan(claim.value) ? "not measured" : fmt::format("{:.6g}", claim.value),
                   bounds(claim), claim.why);
  }
}

}  // namespace

std::string lengthText(double metres) {
  const double size = std::fabs(metres);
  if (size == 0) return "0 mm";
  if (size >= 1) return fmt::format("{:.3f} m", metres);
  if (size >= 1e-3) return fmt::format("{:.2f} mm", metres * 1e3);
  if (size >= 1e-7) return fmt::format("{:.2f} um", metres * 1e6);
  return fmt::format("{:.1e} m", metres);
}

std::string textReport(const io::RunRecord& record, const std::vector<StepReport>& reports) {
  std::string text;
  const Out out = std::back_inserter(text);
  heading(out, record);
  if (!reports.empty()) times(out, record, reports);
  ranks(out, record);
  quality(out, record);
  residuals(out, reports);
  notices(out, reports);
  verdict(out, record);
  return text;
}

}  // namespace rubble::cli
