!> Order of numbers.
module sorting
  use kinds, only: wp
  implicit none
  private
  public :: ascending

contains

  !> The places of the keys from the least to the largest; equal ones stay in their order. Runs of growing length are merged.
  pure function ascending(keys) result(order)
    real(wp), intent(in) :: keys(:)
    integer :: order(size(keys))

    integer, allocatable :: merged(:)
    integer :: length, first, middle, last, n

    n = size(keys)
    allocate (merged(n))
    order = [(first, first=1, n)]
    length = 1
    do while (length < n)
      do first = 1, n, 2*length
        middle = min(first + length - 1, n)
        last = min(first + 2*length - 1, n)
        call merge_runs(keys, order(first:middle), order(middle + 1:last), merged(first:last))
      end do
      order = merged
      length = 2*length
    end do
  end function ascending

  pure subroutine merge_runs(keys, one, other, merged)
    real(wp), intent(in) :: keys(:)
    integer, intent(in) :: one(:), other(:)
    integer, intent(out) :: merged(:)

    integer :: i, j, m
    logical :: from_one

    i = 1
    j = 1
    do m = 1, size(merged)
      from_one = j > size(other)
      if (.not. from_one .and. i <= size(one)) from_one = keys(one(i)) <= keys(other(j))
      if (from_one) then
        merged(m) = one(i)
        i = i + 1
      else
        merged(m) = other(j)
        j = j + 1
      end if
    end do
  end subroutine merge_runs

end module sorting
