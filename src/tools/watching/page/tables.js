import { QUANTITIES } from "./motion.js";

// The data of each chart as a table: heading and rows, named as in statistics.csv; null without data.

export const TABLES = {
  string({ statistics: of }) {
    const early = of?.provisional, paused = of?.paused_until != null;  // paused averages end at an earlier step
    return of && ["vehicle,step,mean,variance,standard_error,theoretical_mean,theoretical_variance,z" + (early ? ",provisional_mean,provisional_variance" : "") + (paused ? ",paused_until" : ""),
      of.variance.map((variance, row) => [row + 1, early ? early.step : paused ? null : of.step, of.mean[row], variance, of.standard_error[row], of.theoretical_mean[row],
        of.theoretical_variance[row], of.score[row], ...early ? [early.mean[row], early.variance[row]] : [], ...paused ? [of.paused_until] : []])];
  },
  gaps({ statistics: of }) {
    return of?.smallest_gap.length ? ["vehicle,smallest_gap,realization,step,collisions,theoretical_collision_bound", of.smallest_gap.map((gap, row) =>
      [row + 1, gap, of.smallest_gap_realization[row], of.smallest_gap_step[row], of.collisions[row], of.collision_bound[row]])] : null;
  },
  curves({ curves: of }) {
    const kind = of?.provisional ? "provisional_" : "";
    return of && [`vehicle,step,${kind}mean,${kind}variance,theoretical_mean,theoretical_variance`, of.followers.flatMap((i, row) => of.step.map((k, at) =>
      [i, k, of.mean[row][at], of.variance[row][at], of.theoretical_mean[row][at], of.theoretical_variance[row][at]]))];
  },
  road(known, road) {
    const of = road.present, offsets = road.offsets();
    return of && ["vehicle,realization,step,position,speed,told_to_follower", of.position.map((position, i) =>
      [i, of.realization, of.step, position, of.speed[i], offsets[i] === undefined ? null : position + offsets[i]])];
  },
  motion(known, road, strip, motion) {
    return motion.columns.length ? ["vehicle,realization,step,seconds,gap,speed,acceleration", motion.picks.flatMap(i => motion.columns.map(column =>
      [i, column.realization, column.step, Number((column.step * motion.period).toPrecision(12)), ...QUANTITIES.map(({ name }) => motion.value(name, i, column))]))] : null;
  },
  strip(known, road, strip) {
    return strip.columns.length ? ["vehicle,realization,step,tracking_error", strip.columns.flatMap(of => of.tracking_error.map((error, row) =>
      [row + 1, of.realization, of.step, error]))] : null;
  },
};
