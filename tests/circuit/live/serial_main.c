/* A board on a plate behind a terminal: argv has the file descriptor of its end, the file of the plate (as board.py
   writes it), how much quicker than real its time goes, and of how many bytes one is wrong, either way (0: none). */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include "thermicon_serial.h"

#define MOST 200
static double capacity[MOST], diagonal[MOST], beside[MOST], heat[MOST], x[MOST], alpha, ohm, gain, speed, felt_C, own_s;
static long wrong_of;
static float out;
static int nodes, line_fd;
static thermicon_serial serial;

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return speed * ((double)now.tv_sec + 1e-9 * (double)now.tv_nsec);
}

/* An implicit step of C dx/dt = -K(I) x + b(I), in which the first node is the hot plate; sensors lag by 0.1 s. */
static void move(double step_s) {
    double amperes = gain * out, pivot[MOST], sum[MOST];
    int i;
    for (i = nodes - 1; i >= 0; i--) {
        double sign = i == 0 ? -1.0 : i == 1 ? 1.0 : 0.0, joule = fabs(sign) * 0.5 * ohm * amperes * amperes;
        double own = diagonal[i] + sign * alpha * amperes + capacity[i] / step_s;
        pivot[i] = own - (i + 1 < nodes ? beside[i] * beside[i] / pivot[i + 1] : 0.0);
        sum[i] = heat[i] + joule - sign * alpha * amperes * 273.15 + capacity[i] / step_s * x[i];
        sum[i] -= i + 1 < nodes ? beside[i] * sum[i + 1] / pivot[i + 1] : 0.0;
    }
    for (i = 0; i < nodes; i++) x[i] = (sum[i] - (i ? beside[i - 1] * x[i - 1] : 0.0)) / pivot[i];
    felt_C += (x[1] - felt_C) * (1.0 - exp(-step_s / 0.1));
}

/* Each reading has noise of its own, 2 mK rms. */
static int measure(void *context, float *display_C) {
    double noise = -6.0;
    int k;
    (void)context;
    for (k = 0; k < 12; k++) noise += (double)rand() / RAND_MAX;
    *display_C = (float)(felt_C + 0.002 * noise);
    return 1;
}

static void put_out(void *context, float command) {
    (void)context;
    out = command;
}

/* The board counts its own turns: a busy computer makes them late, and then quick, never long. */
static uint32_t now_us(void *context) {
    (void)context;
    return (uint32_t)llround(1e6 * own_s);
}

static char hurt(char byte) { return wrong_of && rand() % wrong_of == 0 ? (char)(byte ^ 4) : byte; }

static void say(void *context, const char *line) {
    char sent[256];
    size_t k, length = strlen(line);
    (void)context;
    for (k = 0; k < length; k++) sent[k] = hurt(line[k]);
    if (write(line_fd, sent, length) < 0) return; /* nobody listens */
}

int main(int count, char **words) {
    thermicon_board board = {measure, put_out, NULL, THERMICON_KP, THERMICON_KI, THERMICON_KD,
                             THERMICON_LOWEST_A, THERMICON_HIGHEST_A, now_us, measure, NULL};
    FILE *plate = count == 5 ? fopen(words[2], "r") : NULL;
    double *of[] = {capacity, diagonal, beside, heat, x}, begun_s, mark_s = 0.0;
    int k, n;
    if (!plate || fscanf(plate, "%d %lf %lf %lf", &nodes, &alpha, &ohm, &gain) != 4 || nodes > MOST) return 1;
    for (k = 0; k < 5; k++)
        for (n = 0; n < nodes - (k == 2); n++)
            if (fscanf(plate, "%lf", of[k] + n) != 1) return 1;
    srand((unsigned)getpid()); /* noise of its own in each run */
    line_fd = atoi(words[1]), speed = atof(words[3]);
    wrong_of = atol(words[4]);
    fcntl(line_fd, F_SETFL, fcntl(line_fd, F_GETFL) | O_NONBLOCK);
    felt_C = x[1], begun_s = now_s();
    thermicon_serial_init(&serial, &board, say);
    for (;;) {
        struct timespec turn = {0, (long)(1e9 * 0.001 / speed)};
        char bytes[64];
        long got = read(line_fd, bytes, sizeof bytes), at;
        for (at = 0; at < got; at++) thermicon_serial_byte(&serial, hurt(bytes[at]));
        own_s += 0.01;
        for (n = 0; n < 10; n++) move(0.001); /* 5 ms err by 1 mK after a step: a fit sees that */
        thermicon_serial_step(&serial);
        if (now_s() > mark_s + 0.05) { /* what the test reads: true time, display and current */
            printf("%.3f %.4f %.4f\n", mark_s = now_s(), x[1], (double)out);
            fflush(stdout);
        }
        while (now_s() < begun_s + own_s) nanosleep(&turn, NULL);
    }
}
