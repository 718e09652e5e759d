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
               "D(central ‖ local): divergence from the central filter, nats; of grids summed over "
               "cells"},
    MetricInfo{"hellinger_to_central", kSeries, kMean, false,
               "√(1 − ∫√(pq)): Hellinger distance from the central filter, 0 if equal, at most 1"},
    MetricInfo{"entropy_nats", kSeries, kMean, false,
               "differential entropy of the belief, nats; of grids summed over cells, of Bernoulli "
               "grids the discrete one"},
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
    MetricInfo{"gospa_m", kSeries, kMean, false,
               "of a tracker: GOSPA distance of its confirmed tracks from all targets, m"},
    MetricInfo{"ospa_m", kSeries, kMean, false,
               "of a tracker: OSPA distance of its confirmed tracks from all targets, m"},
    MetricInfo{"missed_targets", kSeries, kMean, false,
               "of a tracker: targets without a track nearer than record.tracks.cutoff_m"},
    MetricInfo{"false_tracks", kSeries, kMean, false,
               "of a tracker: tracks with no target nearer than the cut-off"},
    MetricInfo{"double_tracks", kSeries, kMean, false,
               "of a tracker: second and further tracks of a target"},
    MetricInfo{"alarms_detected_share", kSeries, kMean, false,
               "of an explorer, for each threshold: share of the targets nearer than "
               "record.alarms.gate_m to an alarm of their own"},
    MetricInfo{"alarms_false", kSeries, kMean, false,
               "of an explorer, for each threshold: alarms without such a target"},
    MetricInfo{"alarm_error_m", kSeries, kMean, false,
               "of an explorer, for each threshold: root mean square distance of targets and their "
               "alarms, m; missing without any"},
    MetricInfo{"cells_detected_share", kSeries, kMean, false,
               "of an explorer, for each threshold: share of the cells with a target that are over "
               "it (P_D of an operating curve)"},
    MetricInfo{"cells_false_share", kSeries, kMean, false,
               "of an explorer, for each threshold: share of the cells without one that are over "
               "it (P_F)"},
    MetricInfo{"cells_hearsay", kSeries, kMean, false,
               "of an explorer, for each threshold: cells that are over it here and not in the "
               "central grid, which has every look: alarms of hearsay alone"},
    MetricInfo{"disagreement_probability", kSeries, kMean, false,
               "of agent −1: largest difference of any two explorers' probabilities, mean over "
               "cells"},
    MetricInfo{"place_x_m", kSeries, kMean, false, "of an explorer: where it is, m"},
    MetricInfo{"place_y_m", kSeries, kMean, false, "the same along y, m"},
    MetricInfo{"robot_x_m", kSeries, kMean, false, "of a forager: where it truly is, m"},
    MetricInfo{"robot_y_m", kSeries, kMean, false, "the same along y, m"},
    MetricInfo{"robot_heading_rad", kSeries, kMean, false,
               "of a forager: where it truly looks, counter-clockwise from x, rad"},
    MetricInfo{"trips_so_far", kSeries, kMean, false,
               "of a forager: trips until then; of agent −1: of all together"},
    MetricInfo{"trips_an_hour", kSeries, kMean, false,
               "of agent −1: trips of all foragers within the last 600 s, an hour"},
    MetricInfo{"crumbs_alive", kSeries, kMean, false, "of a forager: crumbs that it knows"},
    MetricInfo{"crumb_error_m", kSeries, kMean, false,
               "of a forager: distance of where a crumb was laid and where it would look for it "
               "now, root mean square over the crumbs that it knows, m; missing without any"},
    MetricInfo{"crumbs_wrong_share", kSeries, kMean, false,
               "of a forager: share of the crumbs that it knows with an error over the sense "
               "radius"},
    MetricInfo{"hearsay_hops_mean", kSeries, kMean, false,
               "of a forager: over how many robots a crumb came, mean over the crumbs that it "
               "knows from others; missing without any"},
    MetricInfo{"trip_length_m", kSeries, kMean, false,
               "of a forager, at the end, for each of its trips (1, 2, … 1000): its way, m"},
    MetricInfo{"trip_duration_s", kSeries, kMean, false, "the same: the time it took, s"},
    MetricInfo{"anees", MetricTable::derived, kMean, false,
               "mean of nees over repetitions, divided by n"},
    MetricInfo{"bytes_per_m_saved", MetricTable::derived, kMean, false,
               "mean of bytes_sent over mean of distance_saved_m: what a metre less error costs; "
               "none where nothing is saved"},
    MetricInfo{"distance_error_m", kScalar, kMean, false,
               "distance of estimate and truth at the end, mean over subjects, m"},
    MetricInfo{
        "distance_saved_m", kScalar, kMean, false,
        "by how much nearer to the truth the agent ends than it would from its own "
        "measurements alone (rule none, same run), mean over the subjects that it saw itself, m"},
    MetricInfo{"nis_mean", kScalar, kMean, false,
               "vᵀ(MΣMᵀ + S)⁻¹v / m of a measurement against the agent's belief just before, mean "
               "over its measurements, 1 if consistent; not where that belief was singular, nor of "
               "trajectories"},
    MetricInfo{"final_claimed_sigma_m", kScalar, kRms, false,
               "claimed standard deviation an axis at the end, rms over subjects, m"},
    MetricInfo{
        "position_error_median_m", kScalar, kMean, false,
        "of moving states: distance of estimate and truth, median over samples and subjects, "
        "m; who knows nothing yet errs infinitely"},
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
    MetricInfo{"position_error_mean_m", kScalar, kMean, false,
               "of a localizer: distance of its estimated and true position, mean over samples, m; "
               "of agent −1: of the central filter of all"},
    MetricInfo{"heading_error_rms_rad", kScalar, kRms, false,
               "of a localizer: error of its heading, root mean square over samples, rad"},
    MetricInfo{"pose_anees", kScalar, kMean, false,
               "of a localizer: eᵀP⁻¹e/3 of its pose, mean over samples, 1 if consistent"},
    MetricInfo{"outside_gate", kScalar, kMean, false,
               "by a localizer: what it saw or heard and took for an outlier"},
    MetricInfo{
        "alarms_found_s", kScalar, Aggregate::median, false,
        "of an explorer: first sample with an alarm at every target, at the first threshold, "
        "s; infinite if there is none; of agent −1: of the central grid"},
    MetricInfo{"cells_seen_share", kScalar, kMean, false,
               "of an explorer: share of the cells that it looked at itself; of agent −1: that "
               "anybody did"},
    MetricInfo{"agents_a_cell", kScalar, kMean, false,
               "of agent −1: how many explorers looked at a cell, mean over cells that were looked "
               "at: 1 if nobody goes where another was"},
    MetricInfo{"distance_flown_m", kScalar, kMean, false,
               "of an explorer: straight from look to look, m"},
    MetricInfo{
        "trips", kScalar, kMean, false,
        "of a forager: how often it reached the event that it had set off to from another, or "
        "from its start; where respawn carries it back because its trail grew too long, it sets "
        "off anew, and what it had driven is part of no trip; of agent −1: of all together"},
    MetricInfo{"distance_driven_m", kScalar, kMean, false,
               "of a forager: true way; of agent −1: of all together, m"},
    MetricInfo{
        "trip_time_mean_s", kScalar, kMean, false,
        "of a forager, and over the trips of all: mean time of a trip since the robot last set "
        "off, without attempts that it abandoned before, s"},
    MetricInfo{"trip_length_mean_m", kScalar, kMean, false, "the same: mean way of a trip, m"},
    MetricInfo{"first_arrival_s", kScalar, Aggregate::median, false,
               "of a forager: end of its first trip; of agent −1: of the first trip of all, s; "
               "infinite if there was none"},
    MetricInfo{"recovery_s", kScalar, Aggregate::median, false,
               "of a forager: from the last time that a barrier or source changed to the end of "
               "its first trip that began after, s; infinite if there was none; of agent −1: the "
               "median of all; not recorded where nothing changed"},
    MetricInfo{"time_following_share", kScalar, kMean, false,
               "of a forager: share of its time in which it followed a trail"},
    MetricInfo{"time_exploring_share", kScalar, kMean, false,
               "of a forager: … in which it had none to follow, or searched around one's end"},
    MetricInfo{"time_panicking_share", kScalar, kMean, false,
               "of a forager: … in which it got itself free after it had not moved"},
    MetricInfo{"blocked_share", kScalar, kMean, false,
               "of a forager: share of its time in which a wall or a robot stopped it"},
    MetricInfo{"crumbs_laid", kScalar, kMean, false, "by a forager: crumbs that it laid"},
    MetricInfo{"crumbs_heard", kScalar, kMean, false,
               "by a forager: crumbs of the packets that it could take in"},
    MetricInfo{"crumbs_taken", kScalar, kMean, false, "by a forager: crumbs heard that were news"},
    MetricInfo{"crumbs_known", kScalar, kMean, false,
               "by a forager: crumbs heard that it had already"},
    MetricInfo{"crumbs_late", kScalar, kMean, false,
               "by a forager: crumbs heard that had outlived their life"},
    MetricInfo{"crumbs_no_room", kScalar, kMean, false,
               "by a forager: crumbs that it had no room for, or that made room for others"},
    MetricInfo{"crumbs_refused", kScalar, kMean, false,
               "by a forager: crumbs heard that were unsound, or from the future"},
    MetricInfo{"messages_no_frame", kScalar, kMean, false,
               "by a forager: packets heard whose frame it could not tell: too few common places"},
    MetricInfo{"messages_not_sent", kScalar, kMean, false,
               "by a forager: packets that its radio did not take: its queue was full"},
    MetricInfo{"trails_abandoned", kScalar, kMean, false,
               "by a forager: trails that became too long before an event"},
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
    MetricInfo{"label_swaps", kScalar, kMean, false,
               "by a tracker: times a label went over to another target than it followed before"},
    MetricInfo{"label_changes", kScalar, kMean, false,
               "by a tracker: times a target got another label that came from no other target"},
    MetricInfo{"merged_tracks", kScalar, kMean, false,
               "by a tracker: times a track became a second one of another target"},
    MetricInfo{"plots", kScalar, kMean, false, "by a tracker: plots in its scans"},
    MetricInfo{"tracks_born", kScalar, kMean, false, "by a tracker: tracks begun with a plot"},
    MetricInfo{"tracks_of_hearsay", kScalar, kMean, false,
               "by a tracker: tracks begun with what another agent told"},
    MetricInfo{"tracks_confirmed", kScalar, kMean, false, "by a tracker: tracks confirmed"},
    MetricInfo{"tracks_ended", kScalar, kMean, false,
               "by a tracker: tracks that ended, missed too often or too uncertain"},
    MetricInfo{"tracks_not_begun", kScalar, kMean, false,
               "by a tracker: tracks there was no room for"},
    MetricInfo{"tracks_apart", kScalar, kMean, false,
               "by a tracker: tracks heard that lay outside the gate of their partner"},
    MetricInfo{"tracks_buried", kScalar, kMean, false,
               "by a tracker: tracks heard of what it had given up"},
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
    MetricInfo{"log_skipped_landmark_sighting", kScalar, kMean, false,
               "log lines not used: a landmark was seen, but robots are believed in, or it is "
               "unknown"},
    MetricInfo{"log_skipped_bad_range", kScalar, kMean, false,
               "log lines skipped: range not positive"},
    MetricInfo{"state_dimension", kScalar, kMean, false, "n, of agent −1"},
};
static_assert(kMetrics[series_metric_count - 1].name == "y_error_m");

}  // namespace

std::span<const MetricInfo> metrics() { return kMetrics; }

}  // namespace hearsay
