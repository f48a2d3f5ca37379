!> Random numbers that are the same on every machine and for any number of ranks.
!>
!> Generator: xoshiro256** of Blackman and Vigna, ACM Trans. Math. Softw. 47 (2021) 36, its state filled by
!> splitmix64 of Steele, Lea and Flood, OOPSLA 2014, fig. 16. Both compute modulo 2^64. Signed integers may
!> not overflow in Fortran, so sums are made of two halves and products of shifted sums.
module random_numbers
  use kinds, only: wp, i8
  implicit none
  private
  public :: random_t, new_random, splitmix64

  !> One stream of random numbers.
  type :: random_t
    integer(i8) :: state(4) = [1_i8, 2_i8, 3_i8, 4_i8]  !< any 256 bits that are not all zero
  contains
    procedure :: next_bits  !< 64 random bits
    procedure :: uniform    !< one number of [0,1)
    procedure :: shuffle    !< the numbers 1 to n in random order
  end type random_t

  integer(i8), parameter :: half = 2_i8**32 - 1_i8  !< mask of the lower 32 bits

contains

  !> A stream that depends on `seed` and on `stream`: different streams of one seed are independent.
  pure function new_random(seed, stream) result(random)
    integer, intent(in) :: seed    !< the user's
    integer, intent(in) :: stream  !< number of the stream
    type(random_t) :: random

    integer(i8) :: counter
    integer :: i

    counter = ieor(int(seed, i8), shiftl(int(stream, i8), 32))
    do i = 1, 4
      call splitmix64(counter, random%state(i))
    end do
  end function new_random

  subroutine next_bits(self, bits)
    class(random_t), intent(inout) :: self
    integer(i8), intent(out) :: bits

    integer(i8) :: shifted

    associate (s => self%state)
      bits = times(ishftc(times(s(2), 2), 7), 3)
      shifted = shiftl(s(2), 17)
      s(3) = ieor(s(3), s(1))
      s(4) = ieor(s(4), s(2))
      s(2) = ieor(s(2), s(3))
      s(1) = ieor(s(1), s(4))
      s(3) = ieor(s(3), shifted)
      s(4) = ishftc(s(4), 45)
    end associate
  end subroutine next_bits

  !> One of the 2^53 evenly spaced numbers of [0,1).
  function uniform(self) result(x)
    class(random_t), intent(inout) :: self
    real(wp) :: x

    integer(i8) :: bits

    call self%next_bits(bits)
    x = real(shiftr(bits, 11), wp)*2.0_wp**(-53)
  end function uniform

  !> Fill `order` with the numbers 1 to its size in random order (Fisher and Yates).
  subroutine shuffle(self, order)
    class(random_t), intent(inout) :: self
    integer, intent(out) :: order(:)

    integer :: i, j, swapped

    do i = 1, size(order)
      order(i) = i
    end do
    do i = size(order), 2, -1
      j = 1 + int(i*self%uniform())
      swapped = order(i)
      order(i) = order(j)
      order(j) = swapped
    end do
  end subroutine shuffle

  !> The next 64 bits that follow `counter`, and the counter moved on.
  pure subroutine splitmix64(counter, bits)
    integer(i8), intent(inout) :: counter
    integer(i8), intent(out) :: bits

    integer(i8), parameter :: step = -7046029254386353131_i8    ! 9E3779B97F4A7C15
    integer(i8), parameter :: first = -4658895280553007687_i8   ! BF58476D1CE4E5B9
    integer(i8), parameter :: second = -7723592293110705685_i8  ! 94D049BB133111EB

    counter = plus(counter, step)
    bits = product_of(ieor(counter, shiftr(counter, 30)), first)
    bits = product_of(ieor(bits, shiftr(bits, 27)), second)
    bits = ieor(bits, shiftr(bits, 31))
  end subroutine splitmix64

  !> a + b modulo 2^64.
  elemental function plus(a, b) result(total)
    integer(i8), intent(in) :: a, b
    integer(i8) :: total

    integer(i8) :: low, high

    low = iand(a, half) + iand(b, half)
    high = shiftr(a, 32) + shiftr(b, 32) + shiftr(low, 32)
    total = ior(shiftl(high, 32), iand(low, half))
  end function plus

  !> (2^power + 1) a modulo 2^64.
  elemental function times(a, power) result(multiple)
    integer(i8), intent(in) :: a
    integer, intent(in) :: power
    integer(i8) :: multiple

    multiple = plus(shiftl(a, power), a)
  end function times

  !> a b modulo 2^64.
  elemental function product_of(a, b) result(total)
    integer(i8), intent(in) :: a, b
    integer(i8) :: total

    integer :: bit

    total = 0_i8
    do bit = 0, 63
      if (btest(b, bit)) total = plus(total, shiftl(a, bit))
    end do
  end function product_of

end module random_numbers
