// SPDX-License-Identifier: Apache-2.0
#include "filters/band_survey.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/timing.h"
#include "filters/pixel_needs.h"
#include "filters/records.h"

namespace vecino {
namespace {

constexpr int kStripRows = 16;  ///< those of a cell of records
constexpr int kStrips = 6;      ///< of a band

int rows_of(RowRange range) {
    return range.end - range.begin;
}

/// Adds what is in a few whole rows of cells.
void survey_strip(const RecordTracer& tracer, RowRange strip, PixelClusters& clusters,
                  BandSurvey& survey) {
    clusters.begin(strip);
    const Stopwatch watch;
    for_each_block(static_cast<std::size_t>(rows_of(strip)), 1, tracer.threads, [&](BlockRange b) {
        (void)clusters.trace_row(tracer, strip.begin + static_cast<int>(b.begin), 1, nullptr);
    });
    survey.pilot_s += watch.seconds();
    // Needs are found by rows above and below.
    const RowRange between{strip.begin + 1, std::max(strip.end - 1, strip.begin + 1)};
    for (const auto& row : find_needs(tracer, clusters, between, 1))
        survey.needy_pixels += static_cast<double>(row.size());
    survey.records += static_cast<double>(count_records({tracer, clusters}, kStripRows));
}

BandSurvey survey_band(const RecordTracer& tracer, const BandRows& band, PixelClusters& clusters) {
    BandSurvey survey;
    const int cells = std::max(rows_of(band.made) / kStripRows, 1);
    const int strips = std::min(cells, kStrips);
    int rows = 0;
    for (int i = 0; i < strips; ++i) {
        const int begin = band.made.begin + (2 * i + 1) * cells / (2 * strips) * kStripRows;
        const RowRange strip{begin, std::min(begin + kStripRows, band.made.end)};
        survey_strip(tracer, strip, clusters, survey);
        rows += rows_of(strip);
    }
    survey.pixels = static_cast<double>(rows_of(band.sampled)) * clusters.width();
    survey.pilot_s *= static_cast<double>(rows_of(band.sampled)) / rows;
    survey.records *= static_cast<double>(rows_of(band.sampled)) / rows;
    survey.needy_pixels *= static_cast<double>(rows_of(band.made)) / rows;
    return survey;
}

}  // namespace

std::vector<BandSurvey> survey_bands(const RecordTracer& tracer, const std::vector<BandRows>& bands,
                                     PixelClusters& clusters) {
    std::vector<BandSurvey> surveys;
    surveys.reserve(bands.size());
    for (const BandRows& band : bands) surveys.push_back(survey_band(tracer, band, clusters));
    return surveys;
}

}  // namespace vecino
