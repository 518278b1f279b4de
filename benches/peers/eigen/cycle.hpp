// The cycle of fric-core written by hand for one robot, with Eigen: the peer that its cost is measured against.
//
// Same equations, no status checks, no slip limit, no effects: sensor pulley of 180°, a guide of 90°, a swivelling last
// pulley; geometry, friction (one Dahl state per cable or per pulley) and wrench.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

namespace peer {

using Eigen::Matrix;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kPulleys = 3;

struct CableParams {
    double mu, sigma_n_per_m, viscous_n_s_per_m, offset_n;
    Vector3d base_m, platform_m;
    Vector3d axis = Vector3d::UnitZ();
    double radius_m = 0.01;
};

struct CableInput {
    double sensor_force_n, length_m, speed_m_per_s;
};

struct CycleInput {
    Vector3d position_m;
    Quaterniond orientation;
    std::array<CableInput, 8> cables;
};

template <int Cables>
struct CycleOutput {
    Matrix<double, Cables, 1> force_at_platform_n;
    Matrix<double, Cables, 1> friction_n;
    Matrix<double, 6, 1> outside_wrench;
    Matrix<double, 6, 1> applied_wrench;
};

// Exact step of Dahl's law, [P] 16.
inline double dahl(double friction_n, double sliding_n, double sigma_n_per_m, double displacement_m) {
    if (displacement_m == 0.0) return friction_n;
    const double target_n = std::copysign(sliding_n, displacement_m);
    return target_n + (friction_n - target_n) * std::exp(-sigma_n_per_m * std::abs(displacement_m) / sliding_n);
}

template <int Cables, bool Lumped>
class Compensator {
public:
    Compensator(std::vector<CableParams> cables, double mass_kg, Vector3d center_of_mass_m)
        : cables_(std::move(cables)), gravity_n_(0.0, 0.0, -9.80665 * mass_kg), center_of_mass_m_(center_of_mass_m) {
        last_length_m_.setConstant(std::nan(""));
        friction_n_.setZero();
    }

    void step(const CycleInput& input, CycleOutput<Cables>& output) {
        const Matrix3d rotation = input.orientation.toRotationMatrix();
        Matrix<double, 6, Cables> structure;
        for (int i = 0; i < Cables; ++i) {
            const CableParams& cable = cables_[i];
            const Vector3d arm_m = rotation * cable.platform_m;
            Vector3d direction;
            const double wrap_factor = last_pulley(cable, input.position_m + arm_m, direction);
            structure.col(i) << direction, arm_m.cross(direction);

            const CableInput& signals = input.cables[i];
            const double change_m = signals.length_m - last_length_m_[i];
            const double displacement_m = std::isnan(change_m) ? 0.0 : change_m;
            last_length_m_[i] = signals.length_m;
            const std::array<double, kPulleys> factors{2.0, std::sqrt(2.0), wrap_factor};
            const double friction_n = Lumped ? lumped(i, factors, signals, displacement_m)
                                             : per_pulley(i, factors, signals, displacement_m);
            output.friction_n[i] = friction_n;
            output.force_at_platform_n[i] = 0.5 * signals.sensor_force_n + friction_n + cable.offset_n;
        }
        output.outside_wrench.noalias() = -(structure * output.force_at_platform_n);
        output.applied_wrench = output.outside_wrench;
        output.applied_wrench.template head<3>() -= gravity_n_;
        output.applied_wrench.template tail<3>() -= (input.orientation * center_of_mass_m_).cross(gravity_n_);
    }

private:
    // Direction from the attachment to the exit point, and 2 sin(β/2) of the wrap.
    static double last_pulley(const CableParams& cable, const Vector3d& attachment_m, Vector3d& direction) {
        const Vector3d relative = attachment_m - cable.base_m;
        const double z = relative.dot(cable.axis);
        const Vector3d radial = relative - z * cable.axis;
        const double distance = radial.norm();
        const double r = cable.radius_m;
        const double x = distance - r;
        const double centre_squared = x * x + z * z;
        const double free = std::sqrt(centre_squared - r * r);
        const double cos = (x * r - z * free) / centre_squared;
        const double sin = (z * r + x * free) / centre_squared;
        const Vector3d exit = (r + r * cos) / distance * radial + r * sin * cable.axis;
        direction = (exit - relative) / free;
        return std::sqrt(2.0 * (1.0 + cos));
    }

    // One Dahl state on the macroscopic Coulomb friction of the cable.
    double lumped(int i, const std::array<double, kPulleys>& factors, const CableInput& signals, double displacement_m) {
        const CableParams& cable = cables_[i];
        const double direction = displacement_m > 0.0 ? 1.0 : displacement_m < 0.0 ? -1.0 : 0.0;
        const double drag_n = cable.viscous_n_s_per_m * signals.speed_m_per_s;
        // Sensor pulley of 180°, [P] 14.
        double coulomb_n = 0.5 * signals.sensor_force_n * (1.0 + direction * cable.mu);
        double viscous_n = 0.5 * drag_n;
        for (int j = 1; j < kPulleys; ++j) {
            const double coupling = direction * cable.mu * factors[j];
            coulomb_n = coulomb_n * (2.0 + coupling) / (2.0 - coupling);
            viscous_n = (viscous_n * (2.0 + coupling) + 2.0 * drag_n) / (2.0 - coupling);
        }
        const double sliding_n = std::abs(coulomb_n - 0.5 * signals.sensor_force_n);
        friction_n_(0, i) = dahl(friction_n_(0, i), sliding_n, cable.sigma_n_per_m, displacement_m);
        return friction_n_(0, i) + viscous_n;
    }

    // One Dahl state on each pulley.
    double per_pulley(int i, const std::array<double, kPulleys>& factors, const CableInput& signals,
                      double displacement_m) {
        const CableParams& cable = cables_[i];
        const double sigma_n_per_m = cable.sigma_n_per_m / kPulleys;
        const double drag_n = cable.viscous_n_s_per_m * signals.speed_m_per_s;
        // Sensor pulley of 180°: F_0 + F_1 = F_s whatever rubs.
        double& first_n = friction_n_(0, i);
        first_n = dahl(first_n, cable.mu * 0.5 * factors[0] * signals.sensor_force_n, sigma_n_per_m, displacement_m);
        double tension_n = 0.5 * (signals.sensor_force_n + first_n + drag_n);
        for (int j = 1; j < kPulleys; ++j) {
            double& stored_n = friction_n_(j, i);
            const double behind_n = tension_n + stored_n + drag_n;
            const double sliding_n = std::max(0.0, cable.mu * 0.5 * factors[j] * (tension_n + behind_n));
            stored_n = dahl(stored_n, sliding_n, sigma_n_per_m, displacement_m);
            tension_n += stored_n + drag_n;
        }
        return tension_n - 0.5 * signals.sensor_force_n;
    }

    std::vector<CableParams> cables_;
    Vector3d gravity_n_, center_of_mass_m_;
    Matrix<double, Cables, 1> last_length_m_;
    Matrix<double, kPulleys, Cables> friction_n_;
};

}  // namespace peer
