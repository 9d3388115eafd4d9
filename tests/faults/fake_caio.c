/* Stand-in for Contec's libcaio.so: the same symbols, on a file in shared memory that FAKE_BENCH
   names. With FAKE_CHATTY in the environment it prints, as some drivers do. */
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define LOGGED 65536

struct bench { // little-endian; bench.py has the same
    double in[16], out[16]; // voltages that the input board reads, and the output board holds
    int64_t calls, fail_at, fail_count, fail_code, failures, // which calls fail, from 1; 0 for none
        writes, stall_us, init_us, // time that every read, and opening a board, takes
        opened;                    // boards that are open
    double angles[2];              // of the fake I2C bus, at 328
    int64_t i2c_fault;             // at 344
    char failed[32];               // name of the call that failed last
    double log[LOGGED][3];         // time of CLOCK_MONOTONIC, channel, volts of each write
};

static struct bench *bench;

static long enter(const char *name)
{
    if (!bench) {
        const char *path = getenv("FAKE_BENCH");
        int file = path ? open(path, O_RDWR) : -1;
        if (file < 0)
            return 10051;
        void *mapped = mmap(0, sizeof *bench, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        close(file);
        if (mapped == MAP_FAILED)
            return 10051;
        bench = mapped;
    }
    int64_t call = ++bench->calls;
    if (getenv("FAKE_CHATTY") && write(1, "AIO: Status OK\n", 15) < 0)
        return 10002;
    if (bench->fail_at && call >= bench->fail_at && call < bench->fail_at + bench->fail_count) {
        bench->failures++;
        strncpy(bench->failed, name, sizeof bench->failed - 1);
        return bench->fail_code;
    }
    return 0;
}

static long device(const char *name, short id)
{
    long code = enter(name);
    return code ? code : (id == 1 || id == 2) ? 0 : 10001;
}

static void wait_for(int64_t us)
{
    struct timespec wait = {us / 1000000, us % 1000000 * 1000};
    if (us)
        nanosleep(&wait, 0);
}

long AioInit(char *name, short *id)
{
    long code = enter("AioInit");
    if (code)
        return code;
    wait_for(bench->init_us);
    // what follows the number is a test's own
    if (strncmp(name, "AIO000", 6) && strncmp(name, "AIO001", 6))
        return 10000;
    *id = strncmp(name, "AIO000", 6) ? 2 : 1;
    bench->opened++;
    return 0;
}

long AioExit(short id)
{
    long code = device("AioExit", id);
    if (!code)
        bench->opened--;
    return code;
}

long AioResetDevice(short id) { return device("AioResetDevice", id); }

static long range_all(const char *name, short id, short range)
{
    long code = device(name, id);
    return code ? code : range ? 11000 : 0;
}

long AioSetAiRangeAll(short id, short range) { return range_all("AioSetAiRangeAll", id, range); }

long AioSetAoRangeAll(short id, short range) { return range_all("AioSetAoRangeAll", id, range); }

long AioMultiAiEx(short id, short channels, float *volts)
{
    long code = device("AioMultiAiEx", id);
    if (code)
        return code;
    if (id != 1 || channels < 1 || channels > 16)
        return 11001;
    wait_for(bench->stall_us);
    for (int k = 0; k < channels; k++)
        volts[k] = (float)bench->in[k];
    return 0;
}

long AioSingleAoEx(short id, short channel, float volts)
{
    long code = device("AioSingleAoEx", id);
    if (code)
        return code;
    if (id != 2 || channel < 0 || channel > 15 || volts < -10.0f || volts > 10.0f)
        return 11002;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    double *row = bench->log[bench->writes % LOGGED];
    row[0] = now.tv_sec + 1e-9 * now.tv_nsec;
    row[1] = channel;
    row[2] = volts;
    bench->out[channel] = volts;
    bench->writes++;
    return 0;
}

long AioGetErrorString(long code, char *text)
{
    strcpy(text, code == 10000   ? "unregistered device name"
                 : code == 10001 ? "invalid device id"
                 : code == 10051 ? "device not found"
                                 : "injected failure");
    return 0;
}
