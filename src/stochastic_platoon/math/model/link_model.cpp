#include "stochastic_platoon/math/model/link_model.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/KroneckerProduct>

#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/eigenvalues.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

bool LossModel::is_independent() const {
  if (!(probability > 0.0)) return true;
  if (trace || by_distance || markov) return false;
  return !mean_burst || std::abs(after_loss() - after_arrival()) < 1e-15;
}

namespace {

Eigen::Map<const Eigen::VectorXd> coefficients(const std::vector<double>& predictor) {
  return {predictor.data(), static_cast<Eigen::Index>(predictor.size())};
}

bool is_one(const TransferFunction& of) {
  const Polynomial &n = of.numerator(), &d = of.denominator();
  return n.size() == 1 && d.size() == 1 && n(0) == d(0);
}

Eigen::MatrixXd squared(const Eigen::MatrixXd& map) {
  return Eigen::kroneckerProduct(map, map);
}

}  // namespace

double second_moment_radius(const LossModel& loss) {
  if (loss.predictor.empty()) return 0.0;
  if (!loss.is_independent()) return spectral_radius(LossChain(loss).second_moments());
  const double q = loss.probability;
  return spectral_radius((1.0 - q) * squared(register_map(coefficients(loss.predictor), false)) +
                         q * squared(register_map(coefficients(loss.predictor), true)));
}

double loss_feedback(const LossModel& loss) {
  if (loss.predictor.empty()) return 0.0;
  // Gramian X = sum R R' of the impulse response R = [r(k), r(k-1), ..] of F; L F is c R one step later.
  Eigen::MatrixXd step = register_map(coefficients(loss.predictor), true);
  const Eigen::Index n = step.rows();
  const Eigen::VectorXd c = step.row(0).transpose();
  step.row(0) *= loss.probability;
  if (spectral_radius(step) >= 1.0) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd x =
      (Eigen::MatrixXd::Identity(n * n, n * n) - squared(step)).partialPivLu().solve(Eigen::VectorXd::Unit(n * n, 0));
  const Eigen::MatrixXd gramian = Eigen::Map<const Eigen::MatrixXd>(x.data(), n, n);
  return (1.0 - loss.probability) * loss.probability * c.dot(gramian * c);
}

double growth(const LossTrace& trace, const std::vector<double>& predictor) {
  if (predictor.empty()) return 0.0;
  const Eigen::MatrixXd arrived = register_map(coefficients(predictor), false),
                        lost = register_map(coefficients(predictor), true);
  Eigen::MatrixXd product = Eigen::MatrixXd::Identity(lost.rows(), lost.rows());
  double exponent = 0.0;
  for (std::size_t k = 0; k < trace.size(); ++k) {
    product = (trace.is_lost(k) ? lost : arrived) * product;
    const double size = product.cwiseAbs().maxCoeff();
    if (size == 0.0) return 0.0;
    product /= size;
    exponent += std::log(size);
  }
  return std::exp(
      std::min(exponent + std::log(spectral_radius(product)), std::log(std::numeric_limits<double>::max())));
}

std::optional<std::string> LinkModel::no_theory() const {
  if (!loses()) return std::nullopt;
  if (loss->by_distance) return "losses depend on the gap";
  LossModel random = *loss;
  random.trace.reset();
  if (loss->trace)
    return formatted("losses follow a recorded trace, of loss probability %.6g and mean burst %.6g (%s have a theory)",
                     loss->probability, *loss->mean_burst,
                     random.alternates() ? "independent losses of this probability" : "random losses with these two");
  if (!random.alternates()) return std::nullopt;
  return "losses and arrivals alternate (mean_burst: 1 at a probability of 0.5), so that no variance settles";
}

bool LinkModel::has_white_noise() const {
  return is_one(noise_filter);
}

// Here and below all members have names, so that a new one does not compile until it has its place.
bool LinkModel::is_white_noise_only() const {
  const auto& [filter, rounding, steps, losses] = *this;
  return is_one(filter) && rounding == 0.0 && steps == 0 && (!losses || losses->probability == 0.0);
}

namespace {

bool same(const TransferFunction& one, const TransferFunction& other) {
  const auto same_polynomial = [](const Polynomial& p, const Polynomial& q) { return p.size() == q.size() && p == q; };
  return same_polynomial(one.numerator(), other.numerator()) && same_polynomial(one.denominator(), other.denominator());
}

}  // namespace

bool operator==(const LossModel& one, const LossModel& other) {
  const auto& [probability, mean_burst, predictor, trace, by_distance, markov] = one;
  const bool same_trace = trace == other.trace || (trace && other.trace && *trace == *other.trace);
  const bool same_chain = markov == other.markov || (markov && other.markov && *markov == *other.markov);
  return same_trace && same_chain && by_distance == other.by_distance && probability == other.probability &&
         mean_burst == other.mean_burst && predictor == other.predictor;
}

bool operator==(const LinkModel& one, const LinkModel& other) {
  const auto& [noise_filter, quantisation_step, delay, loss] = one;
  return loss == other.loss && same(noise_filter, other.noise_filter) && quantisation_step == other.quantisation_step &&
         delay == other.delay;
}

}  // namespace platoon
