// SPDX-License-Identifier: Apache-2.0
//
// A reference's own error, and which results it limits.
#include <cmath>
#include <string>

#include "core/color.h"
#include "core/render.h"
#include "core/scene.h"
#include "eval/metrics.h"
#include "eval/pixel_values.h"
#include "eval/reference_error.h"
#include "eval/report_data.h"
#include "eval/seed_statistics.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/gauss.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

Image disturbed(const Image& image, double sigma, unsigned seed) {
    Gauss gauss(seed);
    Image result = image;
    for (glm::vec3& pixel : result.values())
        for (int c = 0; c < 3; ++c) pixel[c] += static_cast<float>(sigma * gauss());
    return result;
}

double number(const Json& json, const char* key) {
    return json.at(key).get<double>();
}

RenderSettings cornell_settings(int spp) {
    RenderSettings settings;
    settings.size = {64, 64};
    settings.spp = spp;
    settings.max_depth = 2;
    settings.planes = Planes::all();
    return settings;
}

Scene cornell() {
    return load_scene(std::string(VECINO_SOURCE_DIR) + "/scenes/cornell.json");
}

}  // namespace

TEST_CASE("Variance planes tell the error that a far better render finds", "[references]") {
    RenderSettings settings = cornell_settings(64);
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    const Frame reference = render(cornell(), settings).frame;
    settings = cornell_settings(2048);
    settings.seed = 77;
    const Image truth = render(cornell(), settings).frame.radiance;
    const RegionMap regions = regions_of(reference);
    const Json error = reference_error(reference, &regions);
    const Comparison found = compare(reference.radiance, truth, &regions);
    CHECK(error["source"] == "variance");
    // A few pixels that see the lamp in part make most of the whole image's error.
    CHECK(number(error, "psnr_float_db") == Approx(*found.metrics->psnr_float_db).margin(1.5));
    const Json interior = part_of_error(error, "interior");
    const Metrics& expected = (*found.regions)[region_index(Region::interior)].metrics.value();
    CHECK(number(interior, "psnr_float_db") == Approx(*expected.psnr_float_db).margin(0.5));
    CHECK(number(interior, "relmse") == Approx(expected.relmse).epsilon(0.12));
}

TEST_CASE("Variance planes tell the error of skewed and of clipped values, too", "[references]") {
    // A sum of exponential variables, as of samples that find a lamp now and then.
    const float level = GENERATE(0.05f, 0.4f, 0.97f, 1.1f);
    const int terms = GENERATE(4, 64);
    CAPTURE(level, terms);
    const Extent size{150, 150};
    std::mt19937 engine(3);
    Image test(size);
    for (glm::vec3& pixel : test.values())
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < terms; ++i)
                pixel[c] -=
                    level / float(terms) * std::log((float(engine() >> 8) + 0.5f) * 0x1p-24f);
    Frame reference;
    reference.radiance = Image(size, glm::vec3(level));
    reference.variance = Image(size, glm::vec3(level * level / float(terms)));
    const Json error = reference_error(reference, nullptr);
    const Metrics sampled = compare(test, reference.radiance).metrics.value();
    CHECK(number(error, "relmse") == Approx(sampled.relmse).epsilon(0.03));
    CHECK(number(error, "psnr_float_db") == Approx(*sampled.psnr_float_db).margin(0.5));
    CHECK_FALSE(error.contains("regions"));
}

TEST_CASE("Variance planes tell no error of display values where all are clipped", "[references]") {
    Frame reference;
    reference.radiance = Image({4, 4}, glm::vec3(15));
    reference.variance = Image({4, 4}, glm::vec3(0.01f));
    const Json error = reference_error(reference, nullptr);
    CHECK(error["psnr_float_db"].is_null());
    CHECK(number(error, "relmse") == Approx(0.01 / 225.01));
    // Black has no noise of its own: below 0 counts as 0.
    reference.radiance = Image({4, 4}, glm::vec3(-1));
    CHECK(reference_error(reference, nullptr)["psnr_float_db"].is_null());
}

TEST_CASE("nothing is known of a reference without Variance planes or with a NaN", "[references]") {
    Frame reference;
    reference.radiance = Image({4, 4}, glm::vec3(0.5f));
    CHECK(reference_error(reference, nullptr).is_null());
    reference.variance = Image({4, 4}, glm::vec3(0.5f));
    CHECK(reference_error(reference, nullptr).is_object());
    reference.variance(1, 2).y = std::nanf("");
    CHECK(reference_error(reference, nullptr).is_null());
}

TEST_CASE("halves tell the error of their mean, whatever their shares", "[references]") {
    const double weight = GENERATE(0.5, 0.2);
    const Image truth({120, 100}, glm::vec3(0.3f, 0.4f, 0.6f));
    const double one_sample = 0.02;
    const Image first = disturbed(truth, one_sample / std::sqrt(1 - weight), 1);
    const Image second = disturbed(truth, one_sample / std::sqrt(weight), 2);
    Image mean(truth.size());
    for (std::size_t i = 0; i < mean.values().size(); ++i)
        mean.values()[i] =
            float(1 - weight) * first.values()[i] + float(weight) * second.values()[i];
    const RegionMap regions(truth.size(), Region::edge);
    const Json error = reference_error({first, second, weight}, &regions);
    const Metrics found = compare(mean, truth).metrics.value();
    CHECK(error["source"] == "halves");
    CHECK(number(error, "psnr_float_db") == Approx(*found.psnr_float_db).margin(0.1));
    CHECK(number(error, "relmse") == Approx(found.relmse).epsilon(0.03));
    CHECK(part_of_error(error, "edge")["relmse"] == error["relmse"]);
    CHECK(part_of_error(error, "interior")["relmse"].is_null());
}

TEST_CASE("a result within three times of its reference's error is limited by it", "[references]") {
    const auto limited = [](const Json& result_db, const Json& own_db, double own_relmse = 0.1) {
        return limited_by_reference({{"psnr_float_db", result_db}, {"relmse", 0.1}},
                                    {{"psnr_float_db", own_db}, {"relmse", own_relmse}});
    };
    // A third of the deviation is 9.54 dB.
    CHECK(limited(30.47, 40.0) == true);
    CHECK(limited(30.45, 40.0) == false);
    CHECK(limited(45.0, 40.0) == true);
    CHECK(limited(nullptr, 40.0) == true);  // identical images
    CHECK(limited(30.0, nullptr) == std::nullopt);
    CHECK(limited(30.0, nullptr, 0.0) == false);  // a reference without noise
    CHECK(limited_by_reference({{"psnr_float_db", 30.0}}, nullptr) == std::nullopt);
    CHECK(limited_by_reference(nullptr, {{"psnr_float_db", 40.0}}) == std::nullopt);
}

TEST_CASE("bias is told apart from the noise of seeds and of the reference", "[references]") {
    const Extent size{90, 80};
    const double bias = 0.01, sigma = 0.03, reference_sigma = 0.01;
    const Image truth(size, glm::vec3(0.5f));
    std::vector<Image> seeds;
    for (unsigned seed = 1; seed <= 5; ++seed)
        seeds.push_back(disturbed(Image(size, glm::vec3(0.5f + float(bias))), sigma, seed));
    const Image half_a = disturbed(truth, reference_sigma * std::sqrt(2.0), 11);
    const Image half_b = disturbed(truth, reference_sigma * std::sqrt(2.0), 12);
    Image reference(size);
    for (std::size_t i = 0; i < reference.values().size(); ++i)
        reference.values()[i] = 0.5f * (half_a.values()[i] + half_b.values()[i]);

    const Json own = reference_error({half_a, half_b, 0.5}, nullptr);
    const SeedStatistics found = seed_statistics(seeds, reference).value().whole;
    const ErrorSplit display = found.without_reference(mse_of(number(own, "psnr_float_db")));
    const ErrorSplit relative = found.relative.without_reference(number(own, "relmse"));
    const double slope = 1.055 / 2.4 * std::pow(0.5, 1 / 2.4 - 1);  // of the display value
    CHECK(*display.noise == Approx(std::pow(slope * sigma, 2)).epsilon(0.05));
    CHECK(*display.bias2 == Approx(std::pow(slope * bias, 2)).epsilon(0.15));
    CHECK(*relative.noise == Approx(sigma * sigma / 0.26).epsilon(0.03));
    CHECK(*relative.bias2 == Approx(bias * bias / 0.26).epsilon(0.15));
    // The reference's noise is as large as the bias.
    CHECK(*found.bias2 > 1.7 * *display.bias2);
    CHECK(*found.relative.bias2 > 1.7 * *relative.bias2);
    CHECK(display.bias2_by_seed.size() == 5);
}

TEST_CASE("an error is the sum of its bias and its noise", "[references]") {
    const Image reference({20, 20}, glm::vec3(0.4f));
    std::vector<Image> seeds;
    double relmse = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
        seeds.push_back(disturbed(Image({20, 20}, glm::vec3(0.45f)), 0.04, seed));
        relmse += compare(seeds.back(), reference).metrics->relmse / 4;
    }
    const ErrorSplit relative = seed_statistics(seeds, reference).value().whole.relative;
    CHECK(*relative.noise + *relative.bias2 == Approx(relmse).epsilon(1e-9));
}

TEST_CASE("rows and summaries say what their reference limits", "[references]") {
    TinyMatrix run;
    run.json["reference"]["spp"] = 8;
    CHECK(run.run().failed == 0);
    const auto rows = run.rows();
    const Json path = rows.at("box.path.s1");
    CHECK(path["reference_error"]["source"] == "halves");
    CHECK(path["limited_by_reference"] == true);  // as many samples as the reference
    CHECK(path["limited_regions"]["interior"] == true);
    const ReportData data = read_report_data(run.directory);
    const auto& group = data.groups.at(
        index_of(data, *std::ranges::find(data.groups, "box.path", &GroupSummary::group)));
    CHECK(group.is_limited == true);
    CHECK(group.reference_db == path["reference_error"]["psnr_float_db"].get<double>());
    const Json summary = summary_json(group);
    CHECK(summary["limited_by_reference"] == true);
    CHECK(summary["metrics"]["flip"]["mean"].get<double>() > 0);
    const std::string table = summary_table(data.groups);
    CHECK(table.find("* limited by the reference") != std::string::npos);
    CHECK(table.find("bias: 10 log10(1 / B)") != std::string::npos);
}

TEST_CASE("a reference far better than the results limits none", "[references]") {
    TinyMatrix run;
    run.json["reference"]["spp"] = 4096;
    run.json["fixed"]["spp"] = 2;
    run.json["fixed"]["light_sampling"] = "none";
    CHECK(run.run().failed == 0);
    CHECK(run.rows().at("box.path.s1")["limited_by_reference"] == false);
    CHECK(summary_table(read_report_data(run.directory).groups).find('*') == std::string::npos);
}

TEST_CASE("a matrix asks for a costly metric, and cells that lack it are done again",
          "[references]") {
    TinyMatrix run;
    run.run();
    CHECK_FALSE(run.rows().at("box.path.s1")["metrics"].contains("hdr_flip"));
    run.json["measure"] = {{"metrics", {"hdr_flip"}}};
    const RunSummary again = run.run();
    CHECK(again.done == again.cells);
    const Json metrics = run.rows().at("box.path.s1")["metrics"];
    CHECK(metrics["hdr_flip"].get<double>() > 0);
    CHECK(metrics["regions"]["interior"]["hdr_flip"].get<double>() > 0);
    CHECK(run.run().done == 0);
    run.json["measure"] = {{"metrics", {"ssim"}}};
    const Error error = error_of([&] { (void)run.load(); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()).find("/measure/metrics/0: found \"ssim\", allowed: hdr_flip") !=
          std::string::npos);
}
