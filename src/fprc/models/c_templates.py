"""The C code of ``fprc.models.c_header``, with places for names and numbers."""

from string import Template

HEADER = Template("""\
/* $generated
 * $model as C99 or C++, without memory allocation.$origin
 *
 * $equation
 *
 * Inputs of each sample, $rate:
$inputs
 * Output: P_ff, $unit
 *
 * Use:  ${name}_state state;
 *       ${name}_init(&state);
 *       at each sample:  $use
 *
 * Do not compile with -ffast-math: it disables the check for NaN. */
#ifndef ${guard}_H
#define ${guard}_H

#include <math.h>

#define ${guard}_INPUTS $n_inputs

typedef $real ${name}_real;

/* One stream of samples. */
typedef struct {
    ${name}_real row[$n_row]; /* features, the latest tap of each input first */
    int streaming; /* 0 until the first sample */
$memory} ${name}_state;
$prior

/* Begin a new stream at the next sample, which is the assumed input at all earlier times. */
static inline void ${name}_init(${name}_state *state)
{
    state->streaming = 0;
$forget}

/* Begin a new stream; x is the assumed input at all earlier times. If x holds NaN, infinity or a
 * number beyond $largest, the stream begins at the next sample instead. */
static inline void ${name}_reset(${name}_state *state, const ${name}_real x[$n_inputs])
{
    static const int column[$n_row] = {$column};
    int i;

    ${name}_init(state);
    state->streaming = 1;
    for (i = 0; i < $n_inputs; i++) {
        if (!(x[i] >= -$largest && x[i] <= $largest)) {
            state->streaming = 0;
        }
    }
    for (i = 0; i < $n_row; i++) {
        state->row[i] = x[column[i]];
    }
}

/* Return P_ff of the next sample. If x holds NaN, infinity or a number beyond $largest, return NaN
 * and ignore the sample. */
static inline ${name}_real ${name}_step(${name}_state *state, const ${name}_real x[$n_inputs])
{
    /* of each feature: its input; 0 if it is the tap before it one sample later, 1 if it is a
     * low-pass, 2 if it is a play; and the low-pass's epsilon, Eq. (6), or the play's half-width,
     * which is 0 if the feature is the input itself */
    static const int column[$n_row] = {$column};
    static const int kind[$n_row] = {$kind};
    static const ${name}_real number[$n_row] = {$number};
    static const ${name}_real centers[$n_c][$n_row] = {
$centers
    };
    static const ${name}_real weights[$n_c][$n_row] = {
$weights
    };
    static const ${name}_real at_center[$n_c] = { /* each rule's output at its centre, kPa */
        $at_center
    };
    ${name}_real distance2[$n_c], rule[$n_c], nearest, away, beta, total = 0, blended = 0;
    int i, j;

    for (i = 0; i < $n_inputs; i++) {
        if (!(x[i] >= -$largest && x[i] <= $largest)) {
            return (x[i] - x[i]) / (x[i] - x[i]); /* NaN */
        }
    }
    if (!state->streaming) {
        ${name}_reset(state, x);
    }
    for (j = $n_row - 1; j >= 0; j--) {
        const ${name}_real u = x[column[j]], r = number[j];
        ${name}_real *p = &state->row[j];
        if (kind[j] == 0) {
            *p = state->row[j - 1];
        } else if (kind[j] == 1) {
            *p += r * (u - *p);
        } else {
            *p = *p < u - r ? u - r : *p > u + r ? u + r : *p;
        }
    }
    for (i = 0; i < $n_c; i++) {
        distance2[i] = 0;
        rule[i] = at_center[i];
        for (j = 0; j < $n_row; j++) {
            away = state->row[j] - centers[i][j];
            distance2[i] += away * away;
            rule[i] += weights[i][j] * away;
        }
    }
    nearest = distance2[0];
    for (i = 1; i < $n_c; i++) {
        nearest = distance2[i] < nearest ? distance2[i] : nearest;
    }
    for (i = 0; i < $n_c; i++) {
        beta = $exp((nearest - distance2[i]) * $half_over_sigma2); /* 1 / (2 sigma^2) */
        total += beta;
        blended += beta * rule[i];$keep
    }
$finish}
$learn
#endif
""")

#: How a step ends in a model that does not learn.
FINISH = "    return blended / total;\n"

#: What a model that learns has in addition: parts of its state and functions, and more functions.
LEARNING = {
    "memory": Template("""\
    ${name}_real learned[$n_w], covariance[$n_w][$n_w]; /* of the readout's weights */
    ${name}_real phi[$delay][$n_w], base[$delay], p_ff[$delay], p_fb[$delay]; /* the last samples */
    unsigned long k; /* samples of the stream */
"""),
    "prior": Template("""\

/* Covariance of the weights after the training, as if it had lasted $prior_s s. */
static const ${name}_real ${name}_prior[$n_w][$n_w] = {
$prior
};
"""),
    "forget": Template("""\
    state->k = 0;
    {
        int i, j;
        for (i = 0; i < $n_w; i++) {
            state->learned[i] = 0;
            for (j = 0; j < $n_w; j++) {
                state->covariance[i][j] = ${name}_prior[i][j];
            }
        }
    }
"""),
    "keep": Template("\n        rule[i] = beta;"),
    "finish": Template("""\
    {
        const unsigned long at = state->k++ % $delay;
        ${name}_real *phi = state->phi[at], p_learned = 0;
        for (i = 0; i < $n_c; i++) {
            phi[i * ($n_row + 1)] = rule[i] / total;
            for (j = 0; j < $n_row; j++) {
                phi[i * ($n_row + 1) + 1 + j] = rule[i] / total * state->row[j];
            }
        }
        for (i = 0; i < $n_w; i++) {
            p_learned += state->learned[i] * phi[i];
        }
        p_learned = p_learned > $limit ? $limit : p_learned < -$limit ? -$limit : p_learned;
        state->base[at] = blended / total;
        state->p_ff[at] = state->base[at] + p_learned;
        state->p_fb[at] = 0;
        return state->p_ff[at];
    }
"""),
    "learn": Template("""\

/* Note the feedback in kPa that was added to the last P_ff. */
static inline void ${name}_sent(${name}_state *state, ${name}_real p_fb)
{
    if (state->k > 0) {
        state->p_fb[(state->k - 1) % $delay] = p_fb;
    }
}

/* Learn from theta_d - theta and theta of this sample, deg, before its ${name}_step. Nothing is
 * learned while the command is at a limit, the actuator at its stop, or a number no number. */
static inline void ${name}_learn(${name}_state *state, ${name}_real error, ${name}_real theta)
{
    const unsigned long then = state->k % $delay;
    const ${name}_real *phi = state->phi[then];
    ${name}_real gains[$n_w], given = 0, scale = 1, innovation, p_d, updated;
    int i, j;

    if (!state->streaming || state->k < $delay || !(theta > $stop && theta <= $largest)
        || !(error >= -$largest && error <= $largest)) {
        return;
    }
    p_d = state->p_ff[then] + state->p_fb[then];
    if (!(p_d > 0 && p_d < $most)) {
        return;
    }
    for (i = 0; i < $n_w; i++) {
        given += state->learned[i] * phi[i];
        gains[i] = 0;
    }
    innovation = state->p_ff[then] + $kpa_per_deg * error - state->base[then] - given;
    if ((given >= $limit || given <= -$limit) && given * innovation >= 0) {
        return;
    }
    for (j = 0; j < $n_w; j++) {
        for (i = 0; i < $n_w; i++) {
            gains[i] += state->covariance[j][i] * phi[j];
        }
    }
    for (i = 0; i < $n_w; i++) {
        scale += phi[i] * gains[i];
    }
    for (i = 0; i < $n_w; i++) {
        state->learned[i] += gains[i] / scale * innovation;
        for (j = 0; j < $n_w; j++) {
            updated = state->covariance[i][j] - gains[i] * gains[j] / scale;
            state->covariance[i][j] = updated + $mixing * (${name}_prior[i][j] - updated);
        }
    }
}
"""),
}
