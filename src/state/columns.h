#pragma once
/// Columns: bodies stacked on one another, each in touch with at most two others (stages/columns/columns.h).
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Number of bodies from which on contacts of a column are stiffer than others.
inline constexpr int kStiffColumn = 16;

/// The contacts by which a body may belong to a column.
struct ColumnLinks {
  int other[2];           ///< dynamic bodies that it touches; -1: none
  std::uint32_t code[2];  ///< incidences of these contacts
  int member;             ///< 1: it touches at most two bodies, and its rows are all contacts
};

/// A body of a column. The nodes of a column are consecutive, from one end to the other.
struct ColumnNode {
  int body;
  int begin, end;                ///< nodes of its column
  std::uint32_t previous, next;  ///< incidences of the contacts with its neighbors; kNoLink: none
};
inline constexpr std::uint32_t kNoLink = ~std::uint32_t{0};

/// Block row of the Hessian of a column for one node.
struct ColumnWork {
  Dense6 h;  ///< lower triangle of the diagonal block, then its LDL^T factors
  Dense6 e;  ///< off-diagonal block (this, next), then H^-1 e
  Long6 x;   ///< force, then H^-1 f, then the Newton step of the body
};

}  // namespace rubble::RUBBLE_CORE
