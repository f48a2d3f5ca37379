!> The random numbers against published values of their generators, and their uses.
program test_random
  use check, only: expect, expect_close, finish
  use kinds, only: wp, i8
  use random_numbers, only: random_t, new_random, splitmix64
  implicit none

  call known_values()
  call uniform_moments()
  call streams()
  call shuffling()
  call finish()

contains

  !> splitmix64 from 1234567 and xoshiro256** from the state 1, 2, 3, 4, as the authors' C code gives them.
  subroutine known_values()
    integer(i8), parameter :: mixed(5) = [6457827717110365317_i8, 3203168211198807973_i8, &
      -8629252141511181193_i8, 4593380528125082431_i8, -2037821214251327795_i8]
    integer(i8), parameter :: drawn(10) = [11520_i8, 0_i8, 1509978240_i8, 1215971899390074240_i8, &
      1216172134540287360_i8, 607988272756665600_i8, -2273821095074991991_i8, 8476171486693032832_i8, &
      -7851629734111992839_i8, 2904607092377533576_i8]
    type(random_t) :: random
    integer(i8) :: counter, bits(10)
    integer :: i

    counter = 1234567_i8
    do i = 1, 5
      call splitmix64(counter, bits(i))
    end do
    call expect(all(bits(:5) == mixed), 'splitmix64 gives its published numbers')
    do i = 1, 10
      call random%next_bits(bits(i))
    end do
    call expect(all(bits == drawn), 'xoshiro256** gives its published numbers')
  end subroutine known_values

  !> Mean 1/2 and variance 1/12 within four standard errors.
  subroutine uniform_moments()
    integer, parameter :: n = 1000000
    type(random_t) :: random
    real(wp) :: x, mean, square, lowest, highest
    integer :: i

    random = new_random(7, 1)
    mean = 0.0_wp
    square = 0.0_wp
    lowest = 1.0_wp
    highest = 0.0_wp
    do i = 1, n
      x = random%uniform()
      mean = mean + x/n
      square = square + (x - 0.5_wp)**2/n
      lowest = min(lowest, x)
      highest = max(highest, x)
    end do
    call expect_close(mean, 0.5_wp, 8.0_wp*sqrt(1.0_wp/12.0_wp/n), 'mean of uniform numbers')
    call expect_close(square, 1.0_wp/12.0_wp, 4.0_wp*sqrt(0.8_wp/n), 'variance of uniform numbers')
    call expect(lowest >= 0.0_wp .and. lowest < 1.0e-4_wp, 'uniform numbers start at 0')
    call expect(highest < 1.0_wp .and. highest > 0.9999_wp, 'uniform numbers end below 1')
  end subroutine uniform_moments

  subroutine streams()
    type(random_t) :: one, same, other, reseeded
    real(wp) :: x(4)

    one = new_random(5, 1)
    same = new_random(5, 1)
    other = new_random(5, 2)
    reseeded = new_random(6, 1)
    x = [one%uniform(), same%uniform(), other%uniform(), reseeded%uniform()]
    call expect(abs(x(1) - x(2)) <= 0.0_wp, 'the same seed and stream give the same numbers')
    call expect(abs(x(1) - x(3)) > 0.0_wp, 'another stream gives other numbers')
    call expect(abs(x(1) - x(4)) > 0.0_wp, 'another seed gives other numbers')
  end subroutine streams

  subroutine shuffling()
    integer, parameter :: n = 1000
    type(random_t) :: random
    integer :: order(n), empty(0), i
    logical :: found(n)

    random = new_random(1, 1)
    call random%shuffle(order)
    found = .false.
    do i = 1, n
      found(order(i)) = .true.
    end do
    call expect(all(found), 'a shuffled order holds every number once')
    call expect(count(order == [(i, i=1, n)]) < 10, 'and hardly any in its place')
    call random%shuffle(empty)
    call expect(size(empty) == 0, 'nothing can be shuffled')
  end subroutine shuffling

end program test_random
