/*
 * A lander with a guidance of its own, in C: `edl6dof serve` flies the vehicle, this program the powered descent.
 *
 *     edl6dof serve tianwen1 --port 4242        (names its token file)
 *     cc -std=c99 -Wall -Wextra -Werror -O2 -o lander lander.c -lm
 *     ./lander 4242 FILE       the scenario as it stands
 *     ./lander 4242 FILE 7     the flight of seed 7
 *
 * To the ignition of its engine the vehicle flies itself.  From there on this program commands the thrust vector in
 * every cycle, from what the flight computer knows of height, velocity and mass; attitude control stays on board.
 * Exit status 0: it has landed.  The messages are those of docs/serve.md.
 */
#define _POSIX_C_SOURCE 200112L

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

static void fail(const char *what)
{
    fprintf(stderr, "lander: %s\n", what);
    exit(1);
}

/* ---------------------------------------------------------------- writing */

enum { LENGTH = 4, ROOM = 65536 };

/* A request, its length in front. */
struct request {
    unsigned char bytes[1024];
    size_t size;
};

static void put(struct request *request, unsigned char first, uint64_t rest, int count)
{
    if (request->size + 1 + (size_t)count > sizeof request->bytes)
        fail("a request is too long");
    request->bytes[request->size++] = first;
    while (count-- > 0)
        request->bytes[request->size++] = (unsigned char)(rest >> (8 * count));
}

static void put_map(struct request *request, unsigned entries) { put(request, 0xde, entries, 2); }
static void put_list(struct request *request, unsigned entries) { put(request, 0xdc, entries, 2); }
static void put_whole(struct request *request, uint32_t number) { put(request, 0xce, number, 4); }

static void put_number(struct request *request, double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    put(request, 0xcb, bits, 8);
}

static void put_text(struct request *request, const char *text)
{
    put(request, 0xda, strlen(text), 2);
    while (*text)
        put(request, (unsigned char)*text++, 0, 0);
}

/* Begin a request with this many fields beside what is to be done. */
static void begin(struct request *request, const char *what, unsigned fields)
{
    request->size = LENGTH;
    put_map(request, 1 + fields);
    put_text(request, "do");
    put_text(request, what);
}

/* ---------------------------------------------------------------- reading */

enum kind { NOTHING, NUMBER, TEXT, LIST, MAP };

/* One value. */
struct value {
    enum kind kind;
    double number; /* true is 1 */
    size_t size;   /* bytes of a text; entries that follow, of a list or map */
    const unsigned char *bytes;
};

struct rest { const unsigned char *at, *end; }; /* what is left of an answer */

static uint64_t take(struct rest *rest, int count)
{
    uint64_t bits = 0;
    if (rest->end - rest->at < count)
        fail("an answer ends too early");
    while (count-- > 0)
        bits = bits << 8 | *rest->at++;
    return bits;
}

static struct value sized(struct rest *rest, enum kind kind, size_t size)
{
    struct value value = {kind, 0.0, size, rest->at};
    if ((size_t)(rest->end - rest->at) < size) /* an entry takes a byte at least */
        fail("an answer ends too early");
    rest->at += kind == TEXT ? size : 0;
    return value;
}

/* A number of several bytes: a double, without sign, or with one. */
static double as_number(unsigned byte, uint64_t bits, int count)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    if (byte == 0xcb)
        return number;
    return byte < 0xd0 ? (double)bits : ldexp((double)(int64_t)(bits << (64 - 8 * count)), 8 * count - 64);
}

/* The next value; of a list or map its head alone. */
static struct value next(struct rest *rest)
{
    struct value value = {NOTHING, 0.0, 0, NULL};
    unsigned byte = (unsigned)take(rest, 1);
    int count = 1 << (byte & 3); /* bytes of a number */
    if (byte < 0x80 || byte >= 0xe0) {
        value = (struct value){NUMBER, byte < 0x80 ? byte : byte - 256.0, 0, NULL};
    } else if (byte < 0xc0) {
        value = sized(rest, byte < 0x90 ? MAP : byte < 0xa0 ? LIST : TEXT, byte & (byte < 0xa0 ? 15 : 31));
    } else if (byte >= 0xc4 && byte <= 0xc6) { /* bytes */
        value = sized(rest, TEXT, (size_t)take(rest, count));
    } else if (byte >= 0xd9 && byte <= 0xdb) {
        value = sized(rest, TEXT, (size_t)take(rest, 1 << (byte - 0xd9)));
    } else if (byte >= 0xdc) {
        value = sized(rest, byte < 0xde ? LIST : MAP, (size_t)take(rest, byte & 1 ? 4 : 2));
    } else if (byte == 0xc2 || byte == 0xc3) {
        value = (struct value){NUMBER, byte == 0xc3, 0, NULL};
    } else if (byte >= 0xcb && byte <= 0xd3) {
        value = (struct value){NUMBER, as_number(byte, take(rest, count), count), 0, NULL};
    } else if (byte != 0xc0) {
        fail("an answer holds what is not known here");
    }
    return value;
}

static void skip(struct rest *rest)
{
    struct value value = next(rest);
    size_t entries = value.kind == MAP ? 2 * value.size : value.kind == LIST ? value.size : 0;
    while (entries-- > 0)
        skip(rest);
}

/* Whether a map has a key; what follows is then the value. */
static bool find(struct rest map, const char *key, struct rest *found)
{
    struct value head = next(&map);
    for (size_t i = 0; head.kind == MAP && i < head.size; i++) {
        struct value name = next(&map);
        *found = map;
        if (name.kind == TEXT && name.size == strlen(key) && memcmp(name.bytes, key, name.size) == 0)
            return true;
        skip(&map);
    }
    return false;
}

/* The numbers under a key: one, or as many as there are wanted, in a list. */
static void read_numbers(struct rest map, const char *key, double *numbers, size_t count)
{
    struct rest found;
    if (!find(map, key, &found))
        fail("an answer does not hold what was asked for");
    if (count > 1 && next(&found).size != count)
        fail("a list has another length");
    for (size_t i = 0; i < count; i++)
        numbers[i] = next(&found).number;
}

static double read_number(struct rest map, const char *key)
{
    double number;
    read_numbers(map, key, &number, 1);
    return number;
}

/* ---------------------------------------------------------------- the server */

static int connected(int port)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    int line = socket(AF_INET, SOCK_STREAM, 0), at_once = 1;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (line < 0 || connect(line, (struct sockaddr *)&address, sizeof address) != 0)
        fail("nobody serves flights at this port");
    setsockopt(line, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once); /* or each request waits for more */
    return line;
}

/* Send the token, which a file holds. */
static void greet(int line, const char *path)
{
    char token[32];
    FILE *file = fopen(path, "rb");
    if (file == NULL || fread(token, 1, sizeof token, file) != sizeof token)
        fail("the token file cannot be read");
    fclose(file);
    if (send(line, token, sizeof token, 0) != (ssize_t)sizeof token)
        fail("the server is gone");
}

static void receive(int line, unsigned char *bytes, size_t size)
{
    while (size > 0) {
        ssize_t came = recv(line, bytes, size, 0);
        if (came <= 0)
            fail("the server is gone");
        bytes += came;
        size -= (size_t)came;
    }
}

/* Send a request and wait for its answer, which stands until the next. */
static struct rest asked(int line, struct request *request)
{
    static unsigned char bytes[ROOM];
    size_t sent = 0, size = request->size - LENGTH;
    struct rest answer, error;
    for (int i = 0; i < LENGTH; i++)
        request->bytes[i] = (unsigned char)(size >> (8 * (LENGTH - 1 - i)));
    while (sent < request->size) {
        ssize_t went = send(line, request->bytes + sent, request->size - sent, 0);
        if (went <= 0)
            fail("the server is gone");
        sent += (size_t)went;
    }
    receive(line, bytes, LENGTH);
    size = (size_t)bytes[0] << 24 | (size_t)bytes[1] << 16 | (size_t)bytes[2] << 8 | (size_t)bytes[3];
    if (size > ROOM)
        fail("an answer is too long");
    receive(line, bytes, size);
    answer.at = bytes;
    answer.end = bytes + size;
    if (read_number(answer, "ok") == 0.0 && find(answer, "error", &error)) {
        struct value reason = next(&error);
        fprintf(stderr, "lander: %.*s\n", (int)reason.size, (const char *)reason.bytes);
        exit(1);
    }
    return answer;
}

/* ---------------------------------------------------------------- guidance */

struct known {
    double height, gravity, mass, velocity[3]; /* m, m/s2, kg, m/s: north, east, down */
    bool burning;
};

static void observe(struct rest answer, struct known *known)
{
    struct rest observation;
    if (!find(answer, "observation", &observation))
        fail("an answer does not hold what was asked for");
    known->height = read_number(observation, "height_m");
    known->gravity = read_number(observation, "gravity_m_s2");
    known->mass = read_number(observation, "mass_kg");
    known->burning = read_number(observation, "engine_on") != 0.0;
    read_numbers(observation, "v_N_m_s", known->velocity, 3);
}

/* Thrust, N, north, east and down: brake evenly to 1.5 m/s at 12 m, stop all motion over ground by tilting. */
static void guide(const struct known *known, double *thrust)
{
    const double slow = 1.5, brake = 0.9, low = 12.0, along_gain = 0.4, down_gain = 1.0, steepest = 0.2;
    bool braking = known->height > low;
    double down = braking ? sqrt(slow * slow + 2.0 * brake * (known->height - low)) : slow;
    double up = known->gravity + (braking ? brake : 0.0) + down_gain * (known->velocity[2] - down);
    double north = -along_gain * known->velocity[0], east = -along_gain * known->velocity[1];
    double most = steepest * known->gravity, along = hypot(north, east);
    double share = along > most ? most / along : 1.0;
    thrust[0] = known->mass * share * north;
    thrust[1] = known->mass * share * east;
    thrust[2] = -known->mass * fmax(up, 0.5 * known->gravity);
}

/* ---------------------------------------------------------------- the flight */

/* Fly some cycles, under a thrust vector if one is given, and see what is known then. */
static struct rest fly(int line, uint32_t cycles, const double *thrust, struct known *known)
{
    static const char *const names[] = {"height_m", "gravity_m_s2", "mass_kg", "v_N_m_s", "engine_on"};
    const unsigned count = sizeof names / sizeof *names;
    struct request request;
    struct rest answer;
    begin(&request, "step", thrust ? 3 : 2);
    put_text(&request, "cycles");
    put_whole(&request, cycles);
    put_text(&request, "observe");
    put_list(&request, count);
    for (unsigned i = 0; i < count; i++)
        put_text(&request, names[i]);
    if (thrust) {
        put_text(&request, "command");
        put_map(&request, 1);
        put_text(&request, "thrust_n");
        put_list(&request, 3);
        for (int i = 0; i < 3; i++)
            put_number(&request, thrust[i]);
    }
    answer = asked(line, &request);
    observe(answer, known);
    return answer;
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int count, char **words)
{
    struct known known = {0};
    struct request request;
    struct rest answer, found;
    double thrust[3], began;
    int line, cycles = 0;
    if (count < 3)
        fail("say which port and token file: lander PORT FILE [SEED]");
    line = connected(atoi(words[1]));
    greet(line, words[2]);
    begin(&request, "reset", count > 3);
    if (count > 3) {
        put_text(&request, "seed");
        put_whole(&request, (uint32_t)strtoul(words[3], NULL, 10));
    }
    asked(line, &request);
    do {
        answer = fly(line, 25, NULL, &known);
    } while (read_number(answer, "flying") != 0.0 && !known.burning);
    printf("ignition at %.2f s, %.1f m above the ground, %.1f m/s down\n", read_number(answer, "time_s"),
           known.height, known.velocity[2]);
    for (began = seconds(); read_number(answer, "flying") != 0.0; cycles++) {
        guide(&known, thrust);
        answer = fly(line, 1, thrust, &known);
    }
    began = seconds() - began;
    close(line);
    if (!find(answer, "outcome", &found))
        fail("the flight has no end");
    struct value outcome = next(&found);
    printf("%.*s at %.2f s, %.1f kg left; %d cycles at %.0f a second\n", (int)outcome.size, (const char *)outcome.bytes,
           read_number(answer, "time_s"), known.mass, cycles, (double)cycles / began);
    return outcome.size == 6 && memcmp(outcome.bytes, "landed", 6) == 0 ? 0 : 1;
}
