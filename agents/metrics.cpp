#include "agents/metrics.hpp"

#include <array>

namespace hearsay {
namespace {

constexpr auto kSeries = MetricTable::series;
constexpr auto kScalar = MetricTable::scalar;
constexpr auto kMean = Aggregate::mean;
constexpr auto kRms = Aggregate::rms;

constexpr std::array kMetrics = {
    MetricInfo{"rms_error_m", kSeries, kRms, false,
               "√(eᵀe/n): error of the estimated position an axis, m"},
    MetricInfo{"claimed_sigma_m", kSeries, kRms, false,
               "√(tr Σ/n): standard deviation an axis the belief claims, m"},
    MetricInfo{"true_sigma_m", kSeries, kRms, true,
               "√(tr P/n): true standard deviation an axis, by the ledger, m"},
    MetricInfo{"nees", kSeries, kMean, false,
               "eᵀΩe: normalised estimation error squared, mean n if consistent"},
    MetricInfo{"ledger_anees", kSeries, kMean, true,
               "tr(Ω P)/n: the ANEES that the ledger predicts, 1 if consistent"},
    MetricInfo{"ledger_nees", kSeries, kMean, true,
               "eᵀP⁻¹e: error against the ledger's true covariance, χ² with n degrees of freedom"},
    MetricInfo{"kl_to_central_nats", kSeries, kMean, false,
               "D(central ‖ local): divergence from the central filter, nats"},
    MetricInfo{"entropy_nats", kSeries, kMean, false, "differential entropy of the belief, nats"},
    MetricInfo{"multiplicity_mean", kSeries, kMean, true,
               "how often the average measurement in the belief is counted"},
    MetricInfo{"multiplicity_max", kSeries, kMean, true, "how often the most repeated one is"},
    MetricInfo{"multiplicity_share", kSeries, kMean, true,
               "share of the measurements that are counted more than once"},
    MetricInfo{"reach_gap", kSeries, kMean, true,
               "relative distance from a central filter over all measurements that can have "
               "travelled here"},
    MetricInfo{"not_positive", kSeries, kMean, false,
               "1 where the belief's information matrix is indefinite or overflown"},
    MetricInfo{
        "disagreement_m", kSeries, kMean, false,
        "largest distance an axis from this estimate to that of any other agent, m; of agent "
        "−1: between any two; missing if the agent is down, has no estimate or nobody else "
        "has one"},
    MetricInfo{"velocity_error_m_per_s", kSeries, kRms, false,
               "of a moving state: error of the velocity an axis, m/s"},
    MetricInfo{"claimed_velocity_sigma_m_per_s", kSeries, kRms, false,
               "of a moving state: standard deviation of the velocity an axis it claims, m/s"},
    MetricInfo{"x_m", kSeries, kMean, false, "estimated position along x, m"},
    MetricInfo{"y_m", kSeries, kMean, false, "estimated position along y, m"},
    MetricInfo{"x_error_m", kSeries, kRms, false, "x_m less the truth, m"},
    MetricInfo{"y_error_m", kSeries, kRms, false, "y_m less the truth, m"},
    MetricInfo{"anees", MetricTable::derived, kMean, false,
               "mean of nees over repetitions, divided by n"},
    MetricInfo{"distance_error_m", kScalar, kMean, false,
               "distance of estimate and truth at the end, mean over subjects, m"},
    MetricInfo{"final_claimed_sigma_m", kScalar, kRms, false,
               "claimed standard deviation an axis at the end, rms over subjects, m"},
    MetricInfo{"reach_gap_max", kScalar, kMean, true, "largest reach_gap of all samples"},
    MetricInfo{"not_positive_share", kScalar, kMean, false,
               "share of samples with an indefinite or overflown belief"},
    MetricInfo{"fusion_gain_max", kScalar, kMean, false,
               "largest 1 − σ/min(σ own, σ heard) of claimed σ over all fusions"},
    MetricInfo{"fusions", kScalar, kMean, false, "beliefs fused"},
    MetricInfo{"fusions_skipped", kScalar, kMean, false,
               "beliefs heard that the rule could not use"},
    MetricInfo{"news_late", kScalar, kMean, false,
               "of trajectories: measurements and entries of messages about a stamp that was gone"},
    MetricInfo{"messages_refused", kScalar, kMean, false,
               "messages malformed, or older than known"},
    MetricInfo{"measurements", kScalar, kMean, false, "measurements made"},
    MetricInfo{"looks_missed", kScalar, kMean, false,
               "by cameras: looks past the ground, or whose covariance was none"},
    MetricInfo{"look_sigma_along_m", kScalar, kMean, false,
               "by cameras: claimed standard deviation along the line of sight on the ground, rms "
               "over looks, m"},
    MetricInfo{"look_sigma_across_m", kScalar, kMean, false, "the same across it, m"},
    MetricInfo{"look_kl_nats", kScalar, kMean, false,
               "by cameras: D(Monte Carlo ‖ claimed) of a look's ground position, from the same "
               "pose, mean over looks, nats"},
    MetricInfo{"look_variance_gap", kScalar, kMean, false,
               "by cameras: |log(claimed/Monte Carlo variance)| along the line of sight, mean over "
               "looks"},
    MetricInfo{
        "agree_again_s", kScalar, Aggregate::median, false,
        "of agent −1: from record.agreement.from_s to the first sample from which on no two "
        "agents that are up differ by more than within_m an axis on any subject, s; infinite "
        "if they do at the end, or somebody who is up has no estimate"},
    MetricInfo{"packets", kScalar, kMean, false, "packets handed to the radio"},
    MetricInfo{"bytes_sent", kScalar, kMean, false, "bytes sent, headers included"},
    MetricInfo{"air_time_s", kScalar, kMean, false, "time the transmitter was sending, s"},
    MetricInfo{"packets_delivered", kScalar, kMean, false, "packets × receivers that arrived"},
    MetricInfo{"packets_lost", kScalar, kMean, false, "packets × receivers lost on the channel"},
    MetricInfo{"packets_out_of_range", kScalar, kMean, false,
               "packets addressed to somebody out of reach"},
    MetricInfo{"packets_queue_full", kScalar, kMean, false,
               "packets × receivers dropped at the transmitter"},
    MetricInfo{"packets_replaced", kScalar, kMean, false,
               "packets × receivers whose place in the queue newer news took"},
    MetricInfo{"packets_collided", kScalar, kMean, false,
               "packets × receivers at whom another frame was on the air"},
    MetricInfo{"packets_half_duplex", kScalar, kMean, false,
               "packets × receivers that were sending meanwhile"},
    MetricInfo{"packets_receiver_down", kScalar, kMean, false,
               "packets × receivers that were down"},
    MetricInfo{"packets_sender_down", kScalar, kMean, false,
               "packets × receivers whose sender was down"},
    MetricInfo{"packets_jammed", kScalar, kMean, false, "packets × receivers that were jammed"},
    MetricInfo{"packets_expired", kScalar, kMean, false,
               "packets × receivers that waited too long in the queue"},
    MetricInfo{"delivery_ratio", kScalar, kMean, false,
               "packets delivered over packets × receivers; none if nothing was sent"},
    MetricInfo{"queue_delay_mean_s", kScalar, kMean, false,
               "mean time from hand-over to the first bit, s"},
    MetricInfo{"heard_packets", kScalar, kMean, false, "by a source: packets that reached it"},
    MetricInfo{"delay_mean_s", kScalar, kMean, false,
               "by a source: mean time from a packet's hand-over to its arrival here, s"},
    MetricInfo{"goodput_bps", kScalar, kMean, false,
               "by a source: bits of payload that reached it, a second"},
    MetricInfo{"frames", kScalar, kMean, false, "frames sent, repeated ones too"},
    MetricInfo{"acknowledgements", kScalar, kMean, false, "acknowledgements sent for others"},
    MetricInfo{"packets_in_flight_at_end", kScalar, kMean, false,
               "packets × receivers under way when the run ended"},
    MetricInfo{"gossip_written", kScalar, kMean, false,
               "bundles, or versions of slots, that the agent wrote"},
    MetricInfo{"gossip_delivered", kScalar, kMean, false,
               "bundles for it, or versions of slots, that were new to the agent"},
    MetricInfo{"gossip_delay_mean_s", kScalar, kMean, false,
               "mean time from writing to delivery at the agent, s; none if nothing was delivered"},
    MetricInfo{"gossip_duplicates", kScalar, kMean, false, "bundles or versions heard again"},
    MetricInfo{"gossip_late", kScalar, kMean, false,
               "versions heard that were older than its own; bundles too far behind to be told "
               "from those it had"},
    MetricInfo{"gossip_expired", kScalar, kMean, false,
               "bundles whose lifetime ended while it held them or on their way to it"},
    MetricInfo{"gossip_dropped", kScalar, kMean, false,
               "bundles that made room for others, or slots there was no room for"},
    MetricInfo{"gossip_replaced", kScalar, kMean, false,
               "versions that a later one from another agent took the place of"},
    MetricInfo{"gossip_sent", kScalar, kMean, false,
               "packets with a bundle or slot: its own, passed on, or in answer to a summary"},
    MetricInfo{"gossip_summaries", kScalar, kMean, false, "packets that said what it has"},
    MetricInfo{"gossip_malformed", kScalar, kMean, false, "packets it could not read"},
    MetricInfo{"log_skipped_truth_gap", kScalar, kMean, false,
               "log lines skipped: no truth near enough in time"},
    MetricInfo{"log_skipped_unknown_barcode", kScalar, kMean, false,
               "log lines skipped: barcode not in the list"},
    MetricInfo{"log_skipped_robot_sighting", kScalar, kMean, false,
               "log lines not used: another robot was seen"},
    MetricInfo{"log_skipped_bad_range", kScalar, kMean, false,
               "log lines skipped: range not positive"},
    MetricInfo{"state_dimension", kScalar, kMean, false, "n, of agent −1"},
};
static_assert(kMetrics[series_metric_count - 1].name == "y_error_m");

}  // namespace

std::span<const MetricInfo> metrics() { return kMetrics; }

}  // namespace hearsay
