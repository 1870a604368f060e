/* A simulated board: runs the exported player on a plate through a scenario, and prints what became of it by true time.

   stdin: the plate, as board.py writes it, then pairs NAME VALUE. Instants are turns of the loop; `which` is 1 for the
   loop's sensor, 2 for the second one, 3 for both. Real parts have these rules, and the board ends with an error where
   the player does not keep to them:
   - Display and skin are the tests' independent circuit (independent.py), whose wires may be swapped at any turn.
   - A bridge or driver holds what was put out last, however long the program hangs or restarts, and takes only what is
     within its range (-DRANGE; -DA_PER_UNIT is its current).
   - A thermistor follows its plate through glue with a lag (assumed: 0.1 s, as set-points are shaped for, and 0.3 s at
     most) and an offset. Its ADC has steps (ATmega328P data sheet, chapter 24: 10 bits, 0.1 K of a span of 100 K) and
     repeats its last code when it hangs; a broken wire reads the end of the span, or nothing.
   - micros() ticks in 4 us or more, wraps at 2^32 us and only goes on (Arduino reference); a bad one does not.
   - A pin keeps its level, so that nothing tells it twice; a reset leaves it anywhere, here high.
   - Functions get the context that the board was given.
   - An interrupt comes between any two instructions: `inside` says in which function it calls thermicon_abort(). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "double_dip.h"
#include "thermicon_player.h"

enum { DT, TURNS, START, TICK, STAND, BACK, BACK_US, LATE, LATE_US, MUTE, BAD, GOOD, KIND, WHICH, LIE_MK, ABORT, BEGIN,
       SWAP, DRIFT, DRIFT_MK, STEP_MK, SENSORS, OLD, PIN, GAIN, FIRST_MS, SECOND_MS, FIRST_MK, SECOND_MK, INSIDE,
       COUNT };
static const char *const NAMES[COUNT] = {
    "dt_us", "turns", "start_us", "tick_us", "stand_at", "back_at", "back_us", "late_at", "late_us", "mute_at",
    "bad_at", "good_at", "kind", "which", "lie_mK", "abort_at", "begin_at", "swap_at", "drift_at", "drift_mK",
    "step_mK", "sensors", "old", "pin", "gain", "first_ms", "second_ms", "first_mK", "second_mK", "inside"};
static double of[COUNT] = {10000, 8000, 0, 4, 1e9, 1e9, 0, 1e9, 0, 1e9, 1e9, 1e9, 0, 3, 30000, 1e9, 1e9,
                           1e9, 1e9, 0, 0, 3, 0, 1, 1, 100, 100, 0, 0, 0};
enum { LOST = 1, FROZEN, NO_NUMBER, LIES, ON_COURSE }; /* kinds; the last one reads the predicted course and lies */

#define MOST 200
#define DISPLAY 1
static double capacity[MOST], diagonal[MOST], beside[MOST], heat[MOST], x[MOST], alpha, ohm, gain;
static double out, owed_us, true_us, play_us, felt_C[2], marked_us, mark_us, test_us = -1;
static float noise = 0.002f, last_C[2], fell_K[2];
static int nodes, pin = 1, marks, context;
static long turn;
static thermicon_player player;

static void broken(const char *rule) {
    fprintf(stderr, "turn %ld: %s\n", turn, rule);
    exit(1);
}

/* An implicit step of C dx/dt = -K(I) x + b(I), in which the first node is the hot plate. */
static void move(double step_s) {
    double amperes = gain * A_PER_UNIT * (turn >= of[SWAP] ? -out : out), pivot[MOST], sum[MOST];
    int i;
    for (i = nodes - 1; i >= 0; i--) {
        double sign = i == 0 ? -1.0 : i == DISPLAY ? 1.0 : 0.0, joule = fabs(sign) * 0.5 * ohm * amperes * amperes;
        double own = diagonal[i] + sign * alpha * amperes + capacity[i] / step_s;
        pivot[i] = own - (i + 1 < nodes ? beside[i] * beside[i] / pivot[i + 1] : 0.0);
        sum[i] = heat[i] + joule - sign * alpha * amperes * 273.15 + capacity[i] / step_s * x[i];
        sum[i] -= i + 1 < nodes ? beside[i] * sum[i + 1] / pivot[i + 1] : 0.0;
    }
    for (i = 0; i < nodes; i++) x[i] = (sum[i] - (i ? beside[i - 1] * x[i - 1] : 0.0)) / pivot[i];
    for (i = 0; i < 2; i++) felt_C[i] += (x[DISPLAY] - felt_C[i]) * (1 - exp(-1e3 * step_s / of[FIRST_MS + i]));
}

/* Moves the plate as long as the output was held; `least_us` keeps quick loops quick. */
static void settle(double least_us) {
    while (owed_us >= least_us && owed_us > 0) {
        double step_us = owed_us < 10000 ? owed_us : 10000;
        owed_us -= step_us;
        move(1e-6 * step_us);
    }
}

static double course_C(void) {
    long count = sizeof thermicon_course_double_dip / sizeof(int16_t);
    double place = (true_us - play_us) / (1e3 * THERMICON_COURSE_MS), part = place - floor(place);
    long before = (long)place < count - 1 ? (long)place : count - 1, after = before < count - 1 ? before + 1 : before;
    return 0.01 * ((1 - part) * thermicon_course_double_dip[before] + part * thermicon_course_double_dip[after]);
}

enum { LOOP, MEASURE, CLOCK, PUT_OUT, MARK, AFTER }; /* in which function an abort comes */
static long aborted_in = -1; /* the turn in whose step an abort comes */
static void interrupt(int inside) {
    static int is_over;
    if (inside != (int)of[INSIDE] || turn < of[ABORT] || is_over) return;
    is_over = 1;
    aborted_in = inside == LOOP ? turn - 1 : turn;
    thermicon_feed(&player);
    thermicon_abort(&player);
}

static int measured(void *own, int sensor, float *display_C) {
    int bad = turn >= of[BAD] && turn < of[GOOD] && ((int)of[WHICH] >> sensor & 1), kind = (int)of[KIND];
    double now = kind == ON_COURSE && player.state == THERMICON_PLAYING ? course_C() : felt_C[sensor];
    if (own != &context) broken("a sensor is read with another context");
    interrupt(MEASURE);
    now += 1e-3 * (of[FIRST_MK + sensor] + (bad && (kind == LIES || kind == ON_COURSE) ? of[LIE_MK] : 0.0));
    now = of[STEP_MK] > 0 ? round(now * 1e3 / of[STEP_MK]) * of[STEP_MK] * 1e-3 : now + (noise = -noise);
    if (bad && kind == FROZEN) now = last_C[sensor];
    *display_C = last_C[sensor] = bad && kind == NO_NUMBER ? NAN : (float)now;
    return !(bad && kind == LOST);
}
static int measure(void *own, float *display_C) { return measured(own, 0, display_C); }
static int measure_second(void *own, float *display_C) { return measured(own, 1, display_C); }

static void put_out(void *own, float command) {
    if (own != &context) broken("the output is set with another context");
    if (!(fabs(command) <= RANGE)) broken("the driver takes no such command");
    if (player.state == THERMICON_TESTING && test_us < 0) test_us = true_us;
    if (player.aborted && turn > aborted_in && (command < 0 || command > 0)) broken("a current after an abort");
    if (command < out || command > out) settle(0);
    interrupt(PUT_OUT);
    out = command;
}

static void mark(void *own, int on) {
    if (own != &context) broken("the pin is set with another context");
    if (on == pin) broken("the pin is told its level again");
    interrupt(MARK);
    pin = on;
    if (on) marks++, marked_us = true_us;
    else if (marks) mark_us += true_us - marked_us;
}

static uint32_t now_us(void *own) {
    static double stood;
    double now = of[START] + true_us - (turn >= of[BACK] ? of[BACK_US] : 0.0);
    if (own != &context) broken("the clock is read with another context");
    interrupt(CLOCK);
    if (turn < of[STAND]) stood = now;
    return (uint32_t)(uint64_t)(floor(stood / of[TICK]) * of[TICK]);
}

static int is_drive(double since_us) {
    double shown = THERMICON_CLOSED_LOOP ? (double)player.goal : out;
    long place = (long)(since_us * 1e3 / player.icon.period_ns), k;
    for (k = place - 2; k <= place + 2; k++) {
        long at = k < 0 || k >= (long)player.icon.count ? 0 : k;
        if (fabs(shown - (player.icon.offset + player.icon.step * player.icon.wave[at])) < 1e-6) return 1;
    }
    return 0;
}

static void read_numbers(double *into, int count) {
    for (int k = 0; k < count; k++)
        if (scanf("%lf", into + k) != 1) broken("the plate ends early");
}

int main(void) {
    thermicon_board board = {measure, put_out, &context, THERMICON_KP, THERMICON_KI, THERMICON_KD,
                             THERMICON_LOWEST_A, THERMICON_HIGHEST_A, now_us, measure_second, mark};
    thermicon_icon icon = THERMICON_ICON(double_dip);
    char name[32];
    double value, coldest = 99, low = 99, high = -99, largest = 0, free_us = 0, begun_us = 0;
    double rest_s = 1e9, pause_s = 1e9, began = -1, ended = -1, stopped = -1, wrong_s = 0, moved = -1, bad_C = 0;
    int k, begun, first, plays = 0, was;
    if (scanf("%d %lf %lf %lf", &nodes, &alpha, &ohm, &gain) != 4 || nodes > MOST) broken("there is no plate");
    read_numbers(capacity, nodes), read_numbers(diagonal, nodes), read_numbers(beside, nodes - 1);
    read_numbers(heat, nodes), read_numbers(x, nodes);
    while (scanf("%31s %lf", name, &value) == 2) {
        for (k = 0; k < COUNT && strcmp(name, NAMES[k]); k++) continue;
        if (k == COUNT) broken(name);
        of[k] = value;
    }
    felt_C[0] = felt_C[1] = x[DISPLAY];
    board.kp *= (float)of[GAIN], board.ki *= (float)of[GAIN], board.kd *= (float)of[GAIN];
    if (!((int)of[SENSORS] & 1)) board.measure = NULL;
    if (!((int)of[SENSORS] & 2)) board.measure_second = NULL;
    if (of[OLD] > 0) board.now_us = NULL;
    if (!(of[PIN] > 0)) board.mark = NULL;
    begun = thermicon_begin(&player, &board, icon);
    first = thermicon_play(&player, icon);
    for (turn = 0; turn < of[TURNS]; turn++) {
        double dt_us = of[DT] + (turn == of[LATE] ? of[LATE_US] : 0.0);
        true_us += dt_us, owed_us += dt_us;
        settle(1000);
        if (turn >= of[DRIFT]) x[DISPLAY] += 1e-3 * of[DRIFT_MK];
        if (turn < of[MUTE]) thermicon_feed(&player);
        interrupt(LOOP);
        if (turn == of[BEGIN]) {
            pin = 1;
            begun = thermicon_begin(&player, &board, icon);
            free_us = begun_us = true_us, plays = 0, stopped = test_us = -1;
        }
        was = player.state;
        thermicon_step(&player);
        interrupt(AFTER);
        if ((player.state == THERMICON_STOPPED || player.aborted) && fabs(out) > 0) broken("it is on after a stop");
        if (player.aborted && thermicon_play(&player, icon) == THERMICON_OK) broken("it plays after an abort");
        for (k = 0; k < 2; k++) { /* from the last turn that was off to the last one of the test */
            if (was == THERMICON_OFF) fell_K[k] = last_C[k];
            if (was == THERMICON_TESTING && player.state != THERMICON_TESTING) fell_K[k] -= last_C[k];
        }
        if (was == THERMICON_PLAYING && player.state == THERMICON_PLAYING && !player.aborted &&
            !is_drive(true_us - free_us))
            wrong_s += 1e-6 * dt_us;
        if (was == THERMICON_PLAYING && player.state != THERMICON_PLAYING) {
            if (ended < 0) ended = 1e-6 * true_us;
            free_us = true_us;
        }
        if (player.state == THERMICON_STOPPED && stopped < 0) stopped = 1e-6 * true_us;
        if (player.state == THERMICON_PLAYING && x[DISPLAY] < coldest) coldest = x[DISPLAY];
        if (player.state == THERMICON_PLAYING && fabs(out) > largest) largest = fabs(out);
        if (x[DISPLAY] < low) low = x[DISPLAY];
        if (x[DISPLAY] > high) high = x[DISPLAY];
        if (turn <= of[BAD] + 1e6 / of[DT]) bad_C = x[DISPLAY]; /* a second later, when a late sensor has caught up */
        if (turn > of[BAD] && moved < 0 && fabs(x[DISPLAY] - bad_C) > 0.4) moved = 1e-6 * true_us;
        if (thermicon_play(&player, icon) == THERMICON_OK) {
            double waited = 1e-6 * (true_us - (plays ? free_us : begun_us)), *least = plays ? &pause_s : &rest_s;
            if (waited < *least) *least = waited;
            if (began < 0) began = 1e-6 * true_us;
            free_us = play_us = true_us, plays++;
        }
    }
    printf("begun %d first %d began %f ended %f plays %d ", begun, first, began, ended, plays);
    printf("waited %f paused %f stopped %f wrong %f ", rest_s, pause_s, stopped, wrong_s);
    printf("state %d fault %d out %f ", (int)player.state, (int)player.fault, out);
    printf("coldest %f largest %f low %f high %f moved %f ", coldest, largest, low, high, moved);
    printf("fell %f fell_second %f ", fell_K[0], fell_K[1]);
    printf("tested %f marks %d pin %d marked %f\n", 1e-6 * test_us, marks, pin, 1e-6 * mark_us);
    return 0;
}
