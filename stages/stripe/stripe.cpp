#include "stages/stripe/stripe.hpp"

#include "stages/stripe/chains.hpp"
#include "stages/stripe/ridge.hpp"

namespace seampath {

std::vector<Stripe> find_stripes(const GreyImage& image, int count) {
    // Of a picture's million places some pass 4.5 sigma by chance, but not one after the other.
    constexpr double kLeastStrength = 4.5;
    constexpr double kSureStrength = 9;
    const double noise = noise_of(image);
    const auto chains = link_bars(find_bars(image, noise, kLeastStrength), kSureStrength);
    std::vector<Stripe> stripes;
    for (const Chain& line : choose_lines(chains, count)) {
        Stripe stripe = follow_ridge(image, line, noise);
        if (!stripe.points.empty()) {
            stripes.push_back(std::move(stripe));
        }
    }
    return stripes;
}

}  // namespace seampath
