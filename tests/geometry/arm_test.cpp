#include "stages/geometry/arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/geometry/urdf.hpp"
#include "tests/geometry/arms.hpp"

namespace seampath {
namespace arm_test {

using Eigen::Vector3d;
using test::degrees;
using test::kDegree;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kPi = std::numbers::pi;

KDL::Joint turning(const Vector3d& axis) {
    return {KDL::Vector(0, 0, 0), KDL::Vector(axis.x(), axis.y(), axis.z()), KDL::Joint::RotAxis};
}

/// An axis `x, y, z` mm from the one before.
void add_axis(KDL::Chain& chain, double x, double y, double z, const Vector3d& axis) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), KDL::Frame(KDL::Vector(x, y, z))));
    chain.addSegment(KDL::Segment(turning(axis)));
}

void add_tool(KDL::Chain& chain, const KDL::Frame& tool) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), tool));
}

const Vector3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Orocos KDL's own chain of each arm, from its makers' dimensions: of the UR10e its Denavit-Hartenberg parameters.
KDL::Chain kdl_chain(std::size_t arm) {
    KDL::Chain chain;
    if (arm < 2) {
        add_axis(chain, 0, 0, 0, kZ);
        add_axis(chain, 150, 0, 486.5, kY);
        add_axis(chain, 0, 0, arm == 0 ? 475 : 700, kY);
        add_axis(chain, 300, 0, 0, kX);
        add_axis(chain, 300, 0, 0, kY);
        add_axis(chain, 65, 0, 0, kX);
        add_tool(chain, KDL::Frame(KDL::Rotation::RotY(kPi / 2)));
    } else if (arm == 2) {
        const double d[] = {180.7, 0, 0, 174.15, 119.85, 116.55}, a[] = {0, -612.7, -571.55, 0, 0, 0},
                     alpha[] = {kPi / 2, 0, 0, kPi / 2, -kPi / 2, 0};
        for (int i = 0; i < 6; ++i) {
            chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(a[i], alpha[i], d[i], 0)));
        }
    } else if (arm == 3) {
        add_axis(chain, 0, 0, 675, -kZ);
        add_axis(chain, 260, 0, 0, kY);
        add_axis(chain, 680, 0, 0, kY);
        add_axis(chain, 670, 0, -35, -kX);
        add_axis(chain, 0, 0, 0, kY);
        add_axis(chain, 0, 0, 0, -kX);
        add_tool(chain, KDL::Frame(KDL::Rotation::RotY(kPi / 2), KDL::Vector(158, 0, 0)));
    } else {
        add_axis(chain, 0, 0, 450, kZ);
        add_axis(chain, 150, 0, 0, kY);
        add_axis(chain, 0, 0, 600, -kY);
        add_axis(chain, 0, 0, 200, -kX);
        add_axis(chain, 640, 0, 0, -kY);
        add_axis(chain, 100, 0, 0, -kX);
        add_tool(chain, KDL::Frame(KDL::Rotation::RPY(kPi, -kPi / 2, 0)));
    }
    return chain;
}

KDL::JntArray joints(const JointAngles& q) {
    KDL::JntArray array(kArmAxes);
    for (int i = 0; i < kArmAxes; ++i) {
        array(static_cast<unsigned>(i)) = q[i];
    }
    return array;
}

Eigen::Isometry3d isometry(const KDL::Frame& frame) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 3; ++i) {
        pose.translation()[i] = frame.p(i);
        for (int k = 0; k < 3; ++k) {
            pose.linear()(i, k) = frame.M(i, k);
        }
    }
    return pose;
}

Eigen::Isometry3d kdl_forward(const KDL::Chain& chain, const JointAngles& q) {
    KDL::ChainFkSolverPos_recursive solver(chain);
    KDL::Frame frame;
    EXPECT_EQ(solver.JntToCart(joints(q), frame), 0);
    return isometry(frame);
}

void expect_same_pose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const std::string& what) {
    EXPECT_LT((a.translation() - b.translation()).norm(), 1e-6) << what;
    EXPECT_LT(rotation_angle(Eigen::Quaterniond(a.linear()), Eigen::Quaterniond(b.linear())), 1e-9) << what;
}

bool has(const std::vector<JointAngles>& all, const JointAngles& q, double tolerance) {
    return std::any_of(all.begin(), all.end(), [&](const JointAngles& other) {
        return (nearest_turns(other, q) - q).cwiseAbs().maxCoeff() < tolerance;
    });
}

class Arms : public testing::TestWithParam<std::size_t> {
protected:
    std::string name() const { return std::string(kArmNames[GetParam()]); }
    const Arm arm = load_arm(std::string(kArmNames[GetParam()])).arm;
    const KDL::Chain chain = kdl_chain(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Known, Arms, testing::Range<std::size_t>(0, kArmNames.size()), [](const auto& tested) {
    std::string name(kArmNames[tested.param]);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
    return name;
});

TEST_P(Arms, ForwardIsThatOfKdl) {
    std::mt19937_64 generator(1);
    for (int k = 0; k < 300; ++k) {
        const JointAngles q = test::random_posture(arm, generator);
        expect_same_pose(forward(arm, q), kdl_forward(chain, q), name());
    }
}

// What is asked for, and the posture that it came from is among the answers.
TEST_P(Arms, EveryInverseIsRightForKdl) {
    std::mt19937_64 generator(2);
    std::array<int, 9> counts{};
    for (int k = 0; k < 1000; ++k) {
        const JointAngles q = test::random_posture(arm, generator);
        const Eigen::Isometry3d pose = kdl_forward(chain, q);
        const auto all = inverse(arm, pose);
        EXPECT_TRUE(has(all, q, 1e-5)) << name() << " " << q.transpose();
        ASSERT_LE(all.size(), 8u);
        ++counts[all.size()];
        for (const JointAngles& found : all) {
            expect_same_pose(kdl_forward(chain, found), pose, name());
            EXPECT_TRUE((found.array() >= -kPi - 1e-12).all() && (found.array() < kPi + 1e-12).all());
        }
    }
    EXPECT_EQ(counts[1] + counts[3] + counts[5] + counts[7], 0) << "postures come in pairs";
    EXPECT_GT(counts[8], 100);
}

// Levenberg and Marquardt's method from many random postures finds none that inverse() has not.
TEST_P(Arms, NoOtherSolutionIsFoundNumerically) {
    std::mt19937_64 generator(3);
    const Eigen::Matrix<double, 6, 1> weights = (Eigen::Matrix<double, 6, 1>() << 1e-3, 1e-3, 1e-3, 1, 1, 1).finished();
    KDL::ChainIkSolverPos_LMA solver(chain, weights, 1e-11, 500, 1e-15);
    int converged = 0;
    for (int pose = 0; pose < 12; ++pose) {
        const JointAngles q = test::random_posture(arm, generator);
        const auto all = inverse(arm, forward(arm, q));
        KDL::ChainFkSolverPos_recursive forward_solver(chain);
        KDL::Frame frame;
        forward_solver.JntToCart(joints(q), frame);
        for (int start = 0; start < 60; ++start) {
            KDL::JntArray found(kArmAxes);
            if (solver.CartToJnt(joints(test::random_posture(arm, generator)), frame, found) != 0) {
                continue;
            }
            JointAngles other;
            for (int i = 0; i < kArmAxes; ++i) {
                other[i] = found(static_cast<unsigned>(i));
            }
            const Eigen::Isometry3d there = kdl_forward(chain, other);
            if ((there.translation() - forward(arm, q).translation()).norm() > 1e-6 ||
                manipulability(arm, other) < 1e-3) {
                continue;
            }
            ++converged;
            EXPECT_TRUE(has(all, other, 1e-4)) << name() << ": " << other.transpose();
        }
    }
    EXPECT_GT(converged, 50);
}

TEST_P(Arms, SingularPosturesAreSolved) {
    std::mt19937_64 generator(4);
    for (int k = 0; k < 200; ++k) {
        JointAngles q = test::random_posture(arm, generator);
        q[4] = 0;  // axes 4 and 6, or 5 and the parallel ones, in line
        JointAngles reference = JointAngles::Zero();
        reference[3] = q[3];
        reference[5] = q[5];
        const Eigen::Isometry3d pose = kdl_forward(chain, q);
        const auto all = inverse(arm, pose, reference);
        EXPECT_TRUE(has(all, q, 1e-4)) << name() << ": a free axis takes its reference: " << q.transpose();
        EXPECT_LT(manipulability(arm, q), 1e-9);
        for (const JointAngles& found : all) {
            expect_same_pose(kdl_forward(chain, found), pose, name());
        }
    }
    // A stretched elbow: both postures of the elbow are one.
    for (const double bend : {0.0, 1e-9, 1e-6}) {
        JointAngles q = degrees(20, 30, 0, 40, 50, 60);
        const Arm& a = arm;
        // The angle of axis 3 at which its distance from the wrist's end is largest.
        double low = -kPi, high = kPi, best = 0, most = -1;
        for (int i = 0; i <= 200000; ++i) {
            JointAngles at = JointAngles::Zero();
            at[2] = low + (high - low) * i / 200000;
            const Vector3d shoulder = a.axes[1].point;
            JointAngles no_wrist = at;
            const Vector3d end =
                forward(a, no_wrist) * (a.base_from_flange.inverse() *
                                        (a.kind == ArmKind::three_parallel ? a.axes[3].point : a.axes[4].point));
            if ((end - shoulder).norm() > most) {
                most = (end - shoulder).norm();
                best = at[2];
            }
        }
        q[2] = best + bend;
        const Eigen::Isometry3d pose = kdl_forward(chain, q);
        const auto all = inverse(arm, pose);
        EXPECT_FALSE(all.empty()) << name() << " stretched";
        for (const JointAngles& found : all) {
            expect_same_pose(kdl_forward(chain, found), pose, name());
        }
    }
}

TEST_P(Arms, OutOfReachHasNoSolution) {
    Eigen::Isometry3d pose = arm.base_from_flange;
    pose.translation() = Vector3d(3000, 100, 200);
    EXPECT_TRUE(inverse(arm, pose).empty());
    pose.translation() = Vector3d(0, 0, -5000);
    EXPECT_TRUE(inverse(arm, pose).empty());
}

TEST_P(Arms, JacobianIsThatOfKdl) {
    std::mt19937_64 generator(5);
    KDL::ChainJntToJacSolver solver(chain);
    for (int k = 0; k < 50; ++k) {
        const JointAngles q = test::random_posture(arm, generator);
        KDL::Jacobian J(kArmAxes);
        ASSERT_EQ(solver.JntToJac(joints(q), J), 0);
        EXPECT_LT((jacobian(arm, q) - J.data).cwiseAbs().maxCoeff(), 1e-8);
        Eigen::Matrix<double, 6, 6> metres = J.data;
        metres.topRows<3>() /= 1000;
        EXPECT_NEAR(manipulability(arm, q), std::abs(metres.determinant()), 1e-12);
    }
}

TEST_P(Arms, TurnsStayWithinTheLimits) {
    std::mt19937_64 generator(6);
    for (int k = 0; k < 100; ++k) {
        const JointAngles q = test::random_posture(arm, generator);
        const auto ways = within_limits(arm, q);
        EXPECT_TRUE(has(ways, q, 1e-12));
        double product = 1;
        for (int i = 0; i < kArmAxes; ++i) {
            const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
            int turns = 0;
            for (int t = -5; t <= 5; ++t) {
                turns += q[i] + 2 * kPi * t >= axis.lowest && q[i] + 2 * kPi * t <= axis.highest ? 1 : 0;
            }
            product *= turns;
        }
        EXPECT_EQ(static_cast<double>(ways.size()), product);
        for (const JointAngles& way : ways) {
            EXPECT_GE(limit_margin(arm, way), 0);
        }
    }
}

// Poses that the makers' descriptions name.
TEST(Arm, KnownPoses) {
    const Arm abb = load_arm("abb-irb-1600-6-1.2").arm;
    EXPECT_LT((forward(abb, JointAngles::Zero()).translation() - Vector3d(815, 0, 961.5)).norm(), 1e-9);
    EXPECT_LT((forward(abb, degrees(0, 0, 0, 0, 90, 0)).translation() - Vector3d(750, 0, 896.5)).norm(), 1e-9);
    EXPECT_LT(manipulability(abb, JointAngles::Zero()), 1e-12) << "the wrist is stretched";
    const Arm ur = load_arm("ur10e").arm;
    EXPECT_EQ(ur.kind, ArmKind::three_parallel);
    EXPECT_LT((forward(ur, JointAngles::Zero()).translation() - Vector3d(-1184.25, -290.7, 60.85)).norm(), 1e-9);
    const Arm kuka = load_arm("kuka-kr-16-2").arm;
    EXPECT_LT((forward(kuka, degrees(0, -90, 90, 0, 0, 0)).translation() - Vector3d(260 + 670 + 158, 0, 675 + 680 - 35))
                  .norm(),
              1e-9);
    EXPECT_NEAR(kuka.axes[5].highest / kDegree, 350, 1e-9);
    EXPECT_NEAR(kuka.axes[5].max_speed / kDegree, 615, 1e-9);
}

std::string urdf_with(const std::string& from, const std::string& to) {
    std::string text = load_arm("abb-irb-1600-6-1.2").text;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Urdf, SaysWhatIsWrong) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "a.urdf:1: there is no element"},
        {"solid cube", "there is no element"},
        {"<robot name=\"x\">", "<robot> is not closed"},
        {"<sdf/>", "the first element is no <robot>; a URDF was needed"},
        {"<robot/>", "0 turning joints lie between base and flange; 6 were needed"},
        {"<robot><a></b></robot>", "</b> closes <a>"},
        {"<robot/><robot/>", "a second element stands beside the first"},
        {"<robot name='a' name='b'/>", "<robot> has name twice"},
        {"<robot name=\"&copy;\"/>", "an entity that is none of"},
        {urdf_with("xyz=\"0.15 0 0.4865\"", "xyz=\"${a1} 0 0.4865\""), "this is a xacro: run xacro on it first"},
        {urdf_with("xyz=\"0.15 0 0.4865\"", "xyz=\"0.15 0\""), "xyz=\"0.15 0\"; 3 numbers were needed"},
        {urdf_with("xyz=\"0.15 0 0.4865\"", "xyz=\"0.15 nan 0\""), "3 numbers were needed"},
        {urdf_with("type=\"revolute\"", "type=\"prismatic\""), "joint \"joint_1\" is prismatic"},
        {urdf_with("xyz=\"0 0 1\"", "xyz=\"0 0 0\""), "joint \"joint_1\" turns about no direction"},
        {urdf_with("velocity=\"2.6179938779914944\"", ""), "joint \"joint_1\" has no velocity above 0"},
        {urdf_with("lower=\"-3.141592653589793\"", ""), "joint \"joint_1\" has no limits"},
        {urdf_with("<parent link=\"base_link\"/>", "<parent link=\"link_6\"/>"), "comes back to itself"},
        {urdf_with("<child link=\"link_1\"/>", ""), "joint \"joint_1\" has no parent or no child"},
        {urdf_with("xyz=\"0.065 0 0\"", "xyz=\"0.065 0 0.01\""), "only such arms can be solved"}};
    for (const auto& [text, message] : cases) {
        EXPECT_THAT([&text = text] { arm_from_urdf(text, "a.urdf"); }, ThrowsMessage<InputError>(HasSubstr(message)))
            << message;
    }
    EXPECT_THAT([] { load_arm("ur10"); }, ThrowsMessage<InputError>(HasSubstr("did you mean \"ur10e\"?")));
}

TEST(Urdf, TakesCommentsContinuousJointsAndOtherTips) {
    std::string text = urdf_with("type=\"revolute\"", "type=\"continuous\"");
    text.replace(text.find("<link name=\"tool0\"/>"), 20, "<!-- > <joint --> <link name='tool0' />");
    const Arm arm = arm_from_urdf(text, "a.urdf");
    EXPECT_NEAR(arm.axes[0].highest, 2 * kPi, 1e-12);
    for (auto at = text.find("tool0"); at != std::string::npos; at = text.find("tool0")) {
        text.replace(at, 5, "torch");
    }
    EXPECT_EQ(arm_from_urdf(text, "a.urdf").base_from_flange.matrix(), arm.base_from_flange.matrix());
}

}  // namespace arm_test
}  // namespace seampath
