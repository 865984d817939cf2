/// The 6x6 elimination in double, against Eigen.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {
namespace {

using Matrix = Eigen::Matrix<double, 6, 6>;

Dense6 dense(const Matrix& m) {
  Dense6 out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out.m[i][j] = m(i, j);
  return out;
}
Matrix matrix(const Dense6& a) {
  Matrix m;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) m(i, j) = a.m[i][j];
  return m;
}

TEST(Dense6, SolvesStiffSystemsAsEigenDoes) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix r = Matrix::NullaryExpr([&] { return normal(random); });
    const Matrix b = Matrix::NullaryExpr([&] { return normal(random); });
    // a mass beside a stiffness of 1e9 along one direction
    const Matrix h = r * r.transpose() + Matrix::Identity() + 1e9 * r.col(0) * r.col(0).transpose();
    Dense6 factors = dense(h), x = dense(b);
    factor(factors);
    solveFactored(factors, x);
    const Matrix expected = h.ldlt().solve(b);
    EXPECT_LT((matrix(x) - expected).norm(), 1e-6 * expected.norm());
    Long6 one{};
    for (int i = 0; i < 6; ++i) one.v[i] = b(i, 2);
    solveFactored(factors, one);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(one.v[i], x.m[i][2], 1e-12 * expected.norm());
  }
}

TEST(Dense6, SumsRowsAsMatricesDoAndSquaresInTheLowerTriangle) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  using Rows = Eigen::Matrix<double, 3, 6>;
  const Rows a = Rows::NullaryExpr([&] { return normal(random); }),
             b = Rows::NullaryExpr([&] { return normal(random); });
  Long6 x[3], y[3];
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 6; ++i) x[k].v[i] = a(k, i), y[k].v[i] = b(k, i);
  Dense6 outer{}, square{};
  for (int k = 0; k < 3; ++k) addOuter(outer, x[k], y[k], 2.5), addSquare(square, x[k], 2.5);
  EXPECT_LT((matrix(outer) - 2.5 * a.transpose() * b).norm(), 1e-12);
  const Matrix expected = (2.5 * a.transpose() * a).triangularView<Eigen::Lower>();
  EXPECT_LT((matrix(square) - expected).norm(), 1e-12);
}

TEST(Dense6, ProductsAreThoseOfTheTransposedMatrix) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const Matrix a = Matrix::NullaryExpr([&] { return normal(random); }),
               b = Matrix::NullaryExpr([&] { return normal(random); });
  Dense6 c{};
  subtractProduct(c, dense(a), dense(b));
  EXPECT_LT((matrix(c) + a.transpose() * b).norm(), 1e-12);
  Long6 x{}, y{};
  for (int i = 0; i < 6; ++i) x.v[i] = i + 1;
  subtractProduct(y, dense(a), x);
  for (int i = 0; i < 6; ++i) {
    double sum = 0;
    for (int k = 0; k < 6; ++k) sum += a(k, i) * (k + 1);
    EXPECT_NEAR(y.v[i], -sum, 1e-12);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
