!> Words of a case file as numbers and logicals, and the ranges these must lie in.
module case_values
  use case_scanner, only: word_t
  use constants, only: is_set
  use kinds, only: wp, i8
  use text, only: lower_case, quoted
  implicit none
  private
  public :: range_t, new_range, to_real, to_integer, to_logical, as_written

  !> An interval; an end that is unset is at infinity.
  type :: range_t
    character(len=:), allocatable :: text          !< '(0, 1]'
    real(wp) :: least = -huge(1.0_wp)
    real(wp) :: most = huge(1.0_wp)
    logical :: least_included = .true.
    logical :: most_included = .true.
  contains
    procedure :: has
    procedure :: demand
  end type range_t

  ! No quantity is beyond these, and powers of what lies between do not overflow.
  real(wp), parameter :: smallest = 1.0e-30_wp, largest = 1.0e30_wp

  character(len=*), parameter :: digits = '0123456789'

contains

  !> The interval of a text such as '(0, 1]', '[2, inf)'; nothing means any number.
  pure function new_range(text) result(range)
    character(len=*), intent(in) :: text
    type(range_t) :: range

    integer :: comma

    range%text = text
    if (len(text) == 0) return
    comma = index(text, ',')
    range%least_included = text(1:1) == '['
    range%most_included = text(len(text):) == ']'
    if (index(text(:comma), 'inf') == 0) read (text(2:comma - 1), *) range%least
    if (index(text(comma:), 'inf') == 0) read (text(comma + 1:len(text) - 1), *) range%most
  end function new_range

  elemental function has(self, x)
    class(range_t), intent(in) :: self
    real(wp), intent(in) :: x
    logical :: has

    has = x > self%least .or. (self%least_included .and. x >= self%least)
    has = has .and. (x < self%most .or. (self%most_included .and. x <= self%most))
  end function has

  !> What the range asks for, in words.
  pure function demand(self)
    class(range_t), intent(in) :: self
    character(len=:), allocatable :: demand

    integer :: comma

    comma = index(self%text, ',')
    demand = 'must lie in '//self%text
    if (self%most < huge(1.0_wp)) return
    demand = 'must be greater than '//self%text(2:comma - 1)
    if (self%least_included) demand = 'must be at least '//self%text(2:comma - 1)
  end function demand

  !> The number a word stands for, or why it stands for none.
  pure subroutine to_real(word, x, message)
    type(word_t), intent(in) :: word
    real(wp), intent(out) :: x
    character(len=:), allocatable, intent(out) :: message  !< nothing if all is well

    character(len=:), allocatable :: number
    integer :: mark, exponent

    x = 0.0_wp
    number = lower_case(word%text)
    select case (number)
    case ('nan', '+nan', '-nan', 'inf', '+inf', '-inf', 'infinity', '+infinity', '-infinity')
      message = 'must be finite'
      return
    case default
      message = ''
    end select
    mark = scan(number, 'ed')
    if (mark == 0) mark = len(number) + 1
    if (word%is_text .or. .not. (is_decimal(number(:mark - 1)) .and. is_whole(number(mark + 1:), mark > len(number)))) then
      message = 'must be a real number'
      return
    end if
    exponent = 0
    if (mark < len(number)) read (number(mark + 1:), *) exponent
    message = 'must be 0 or of a size between 1e-30 and 1e30'
    if (abs(exponent) > 99 .or. mark > 100) return  ! to read it might overflow
    read (number, *) x
    if ((abs(x) >= smallest .and. abs(x) <= largest) .or. .not. abs(x) > 0) message = ''
  end subroutine to_real

  pure subroutine to_integer(word, n, message)
    type(word_t), intent(in) :: word
    integer, intent(out) :: n
    character(len=:), allocatable, intent(out) :: message

    integer(i8) :: long

    n = 0
    message = 'must be a whole number'
    if (word%is_text .or. .not. is_whole(word%text, .false.)) return
    message = 'is too large'
    read (word%text, *) long  ! 12 characters at most
    if (abs(long) > huge(n)) return
    message = ''
    n = int(long)
  end subroutine to_integer

  pure subroutine to_logical(word, flag, message)
    type(word_t), intent(in) :: word
    logical, intent(out) :: flag
    character(len=:), allocatable, intent(out) :: message

    flag = .false.
    message = 'must be true or false'
    if (word%is_text) return
    select case (lower_case(word%text))
    case ('.true.', 'true', '.t.', 't')
      flag = .true.
    case ('.false.', 'false', '.f.', 'f')
    case default
      return
    end select
    message = ''
  end subroutine to_logical

  !> Sign, digits, at most one point, at least one digit.
  pure function is_decimal(text)
    character(len=*), intent(in) :: text
    logical :: is_decimal

    integer :: first, point

    is_decimal = .false.
    if (len(text) == 0) return
    first = 1
    if (scan(text(1:1), '+-') == 1) first = 2
    point = index(text, '.')
    if (verify(text(first:), digits//'.') > 0 .or. scan(text(first:), digits) == 0) return
    is_decimal = point == 0 .or. index(text(point + 1:), '.') == 0
  end function is_decimal

  !> Sign and digits; nothing at all only where that is allowed.
  pure function is_whole(text, may_be_empty)
    character(len=*), intent(in) :: text
    logical, intent(in) :: may_be_empty
    logical :: is_whole

    is_whole = may_be_empty .and. len(text) == 0
    if (len(text) == 0 .or. len(text) > 12) return
    is_whole = verify(text, digits) == 0
    if (len(text) > 1 .and. scan(text(1:1), '+-') == 1) is_whole = verify(text(2:), digits) == 0
  end function is_whole

  !> Values as the case file has them, the first few of many.
  pure function as_written(words) result(text)
    type(word_t), intent(in) :: words(:)
    character(len=:), allocatable :: text

    integer, parameter :: enough = 6
    integer :: i

    text = ''
    do i = 1, min(enough, size(words))
      if (i > 1) text = text//', '
      if (words(i)%is_text) then
        text = text//quoted(words(i)%text)
      else
        text = text//words(i)%text
      end if
    end do
    if (size(words) > enough) text = text//', ...'
  end function as_written

end module case_values
