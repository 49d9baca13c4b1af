#include "import/inertia.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace aurasim::importing {
namespace {

using core::Mat3;
using core::Vec3;

constexpr double kNoProduct = 1e-12;  ///< relative to the largest moment: rounding error of a product of inertia

/// Order of columns in which column i is as near as possible to axis i.
std::array<int, 3> nearest_order(const Mat3& axes) {
  std::array<int, 3> order = {0, 1, 2}, best = order;
  double most = -1;
  do {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += std::abs(axes(i, order[i]));
    if (sum > most + 1e-9) {
      most = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

}  // namespace

PrincipalInertia principal_inertia(const Mat3& tensor_L) {
  const double largest = tensor_L.cwiseAbs().maxCoeff();
  const Mat3 products = tensor_L - Mat3(tensor_L.diagonal().asDiagonal());
  if (products.cwiseAbs().maxCoeff() <= kNoProduct * largest) return {Mat3::Identity(), tensor_L.diagonal()};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(tensor_L);
  const std::array<int, 3> order = nearest_order(solver.eigenvectors());
  PrincipalInertia result;
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = solver.eigenvectors().col(order[i]);
    result.R_LB.col(i) = axis[i] < 0 ? Vec3(-axis) : axis;
    result.moments[i] = solver.eigenvalues()[order[i]];
  }
  if (result.R_LB.determinant() < 0) result.R_LB.col(2) *= -1;
  return result;
}

core::Pose body_pose(const Link& link) {
  return link.X_WL * core::Pose{link.p_LB, core::Quat(principal_inertia(link.I_BL).R_LB)};
}

bool is_physical(const Vec3& moments) {
  const double sum = moments.sum();
  return moments.allFinite() && moments.minCoeff() > 0 && 2 * moments.maxCoeff() <= sum * (1 + 1e-9);
}

}  // namespace aurasim::importing
