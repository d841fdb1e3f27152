#include "pipeline/artefact.hpp"

#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "pipeline/codec.hpp"
#include "pipeline/digest.hpp"

namespace seampath {
namespace artefact_test {

/// Doubles of any sign and size, infinities and NaN among them.
class Numbers {
public:
    explicit Numbers(unsigned seed) : bits_(seed) {}
    double any() {
        const auto value = std::bit_cast<double>(bits_());
        return std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value;
    }
    Eigen::Vector3d vector() { return {any(), any(), any()}; }
    bool flip() { return bits_() % 2 == 0; }
    std::size_t below(std::size_t n) { return bits_() % n; }

private:
    std::mt19937_64 bits_;
};

/// The second writing equals the first only if every bit came back: encode() tells all doubles apart.
template <class T>
void expect_round_trip(const T& value) {
    const std::string text = encode(value);
    T back;
    decode(text, back);
    EXPECT_EQ(encode(back), text);
}

FlankSurface random_surface(Numbers& n) {
    return {static_cast<SurfaceShape>(n.below(4)),
            n.vector(),
            n.vector(),
            n.any(),
            n.flip(),
            n.flip(),
            n.any(),
            n.any(),
            n.vector(),
            n.vector(),
            n.vector(),
            n.any(),
            {n.any(), n.any()}};
}

Extraction random_extraction(Numbers& n) {
    Extraction e;
    e.seams.resize(n.below(4));
    for (auto& seam : e.seams) {
        seam = {static_cast<JointKind>(n.below(6)),     n.flip(), n.any(), "two surfaces\n", {}, {}, {},
                {static_cast<std::size_t>(n.below(50))}};
        if (n.flip()) {
            seam.surfaces = {random_surface(n), random_surface(n), {n.any(), n.any(), n.any()}};
        }
        for (std::size_t i = 0; i < 20; ++i) {
            seam.points.push_back({n.vector(), n.vector(), n.vector(), n.any(), n.flip()});
            const auto measured = [&] { return Measured{n.any(), n.any()}; };
            seam.groove.push_back(
                {measured(), measured(), measured(), measured(), measured(), measured(), measured(), measured()});
        }
    }
    e.spacing_mm = n.any();
    e.noise_mm = n.any();
    e.orientation_reason = "from the \"sensor\"\n\x01";
    e.remarks = {"one", ""};
    return e;
}

SeamModel random_model(Numbers& n) {
    SeamModel model;
    model.kind = static_cast<JointKind>(n.below(6));
    model.closed = n.flip();
    model.curve = {n.flip(), {n.any(), n.any()}, {n.vector(), n.vector(), n.vector()}};
    model.length_mm = n.any();
    model.flanks = {{n.any(), n.vector(), n.vector(), n.any(), n.flip()}};
    model.residual_rms_mm = n.any();
    model.residual_max_mm = n.any();
    model.degrees_of_freedom = n.any();
    model.model = "saddle";
    model.reason = "both pipes are \"round\"";
    model.band = {{n.any(), n.any()}};
    model.corners_mm = {n.any(), n.any()};
    if (n.flip()) {
        const Measured estimate{n.any(), n.any()};
        model.saddle = {static_cast<SurfaceShape>(n.below(4)), estimate, {}, Measured{n.any(), n.any()}, estimate};
    }
    return model;
}

Deviation random_deviation(Numbers& n) {
    Deviation d{{{n.any(), n.vector(), n.any(), n.any(), n.any(), n.any(), n.flip()}},
                n.any(),
                n.any(),
                n.any(),
                n.any(),
                n.any(),
                n.any(),
                n.any(),
                n.any(),
                n.flip(),
                "it passes"};
    return d;
}

Plan random_plan(Numbers& n) {
    Plan plan{{}, n.any(), n.any(), n.any(), n.any(), {}, {}, {}, {}};
    for (int i = 0; i < 10; ++i) {
        const Eigen::Quaterniond q(n.any(), n.any(), n.any(), n.any());
        plan.waypoints.push_back(
            {i / 5, i % 5, static_cast<WaypointKind>(n.below(6)), n.any(), n.vector(), q, n.any(), n.any(), n.any()});
        plan.passes.push_back({i / 5, i % 5, i % 2, n.any(), n.any(), n.any(), n.any(), n.any(), n.any()});
        plan.travel.push_back({i / 5, i % 5, n.any(), n.any(), n.any(), n.any(), n.any(), n.any(), n.any()});
        plan.refused.push_back({i, n.any(), n.any(), "it touches"});
    }
    if (n.flip()) {
        const auto six = [&n] { return std::array<double, 6>{n.any(), n.any(), n.any(), n.any(), n.any(), n.any()}; };
        ArmTravel arm{"UR10e", n.flip(), "it goes", six(),   six(),   six(), six(), six(),
                      six(),   n.any(),  n.any(),   n.any(), n.any(), {},    {}};
        for (int i = 0; i < 5; ++i) {
            arm.samples.push_back(
                {i, static_cast<WaypointKind>(n.below(6)), i - 1, n.any(), n.any(), six(), n.any(), n.any()});
        }
        if (n.flip()) {
            arm.shift_mm = n.vector();
        }
        plan.arm = arm;
    }
    return plan;
}

TEST(Codec, EveryStageResultReadsBackExactly) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE(seed);
        Numbers n(seed);
        expect_round_trip(random_extraction(n));
        expect_round_trip(std::vector<Nodes>{{{0, n.below(1u << 31), 7}, n.any(), {}},
                                             {{1}, n.any(), NodeLine{{n.any()}, {n.vector()}, n.any(), n.any()}}});
        expect_round_trip(std::vector<SeamModel>{random_model(n), random_model(n)});
        expect_round_trip(std::vector<Deviation>{random_deviation(n)});
        expect_round_trip(random_plan(n));
    }
}

TEST(Codec, KeepsEveryMemberInItsPlace) {
    const Plan plan{{{3, 4, WaypointKind::weld_end, 0.1, {1, 2, 3}, {0.5, -0.5, 0.25, -0.0}, 8, 9, 10}},
                    0.5,
                    0.25,
                    2,
                    60,
                    {},
                    {},
                    {},
                    {}};
    Plan back;
    decode(encode(plan), back);
    const Waypoint& w = back.waypoints.at(0);
    EXPECT_EQ(w.seam, 3);
    EXPECT_EQ(w.index, 4);
    EXPECT_EQ(w.kind, WaypointKind::weld_end);
    EXPECT_EQ(w.station_mm, 0.1);
    EXPECT_EQ(w.p, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(w.q.coeffs(), Eigen::Vector4d(-0.5, 0.25, 0, 0.5));
    EXPECT_TRUE(std::signbit(w.q.z()));
    EXPECT_EQ(w.speed_mm_s, 8);
    EXPECT_EQ(w.time_s, 9);
    EXPECT_EQ(w.sigma_mm, 10);
    EXPECT_EQ(back.duration_s, 60);
}

TEST(Codec, RefusesOtherText) {
    Numbers n(1);
    Plan plan;
    EXPECT_THROW(decode("", plan), std::runtime_error);
    EXPECT_THROW(decode("{}", plan), std::runtime_error);
    EXPECT_THROW(decode("[[[[", plan), std::runtime_error);
    std::string text = encode(random_plan(n));
    text.replace(text.find("\"kind\":\"") + 8, 1, "?");
    EXPECT_THROW(decode(text, plan), std::runtime_error);
}

TEST(Digest, IsSha256) {
    // FIPS 180-4's example "abc"
    EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(build_id().size(), 64u);
}

TEST(Artefact, IsTakenOnlyWholeAndWithItsOwnStageAndKey) {
    const std::string key(64, 'a');
    const std::string text = artefact_text("fit", key, "[1,2,3]");
    EXPECT_EQ(artefact_content(text, "fit", key), "[1,2,3]");
    EXPECT_FALSE(artefact_content(text, "fit", std::string(64, 'b')));
    EXPECT_FALSE(artefact_content(text, "plan", key));
    EXPECT_FALSE(artefact_content("", "fit", key));
    for (std::size_t i = 0; i < text.size(); ++i) {
        EXPECT_FALSE(artefact_content(text.substr(0, i), "fit", key)) << "cut at " << i;
        std::string damaged = text;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        EXPECT_FALSE(artefact_content(damaged, "fit", key)) << "damaged at " << i;
    }
}

TEST(Artefact, KeyFollowsFromStageOptionsAndInputs) {
    const auto key = [](const char* stage, const char* options, std::vector<std::string> inputs) {
        return artefact_key(stage, options, inputs);
    };
    const std::string base = key("fit", "{}", {"a", "b"});
    EXPECT_EQ(key("fit", "{}", {"a", "b"}), base);
    EXPECT_NE(key("place", "{}", {"a", "b"}), base);
    EXPECT_NE(key("fit", "{ }", {"a", "b"}), base);
    EXPECT_NE(key("fit", "{}", {"ab", ""}), base);
    EXPECT_NE(key("fit", "{}", {"a"}), base);
}

}  // namespace artefact_test
}  // namespace seampath
