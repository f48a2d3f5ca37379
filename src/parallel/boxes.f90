!> The grid of gas cells cut into one box per rank.
!>
!> The ranks form a Cartesian grid themselves, x fastest: rank = p1 + P1 (p2 + P2 p3), places from 0.
module boxes
  use communicator, only: communicator_t
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  implicit none
  private
  public :: boxes_t, new_boxes

  integer, parameter :: no_neighbour = -1
  integer, parameter :: thinnest = 2      !< cells of the thinnest box along a direction that is cut: the halo's width
  real(wp), parameter :: uneven = 1.2_wp  !< how much larger the largest box may get for the sake of even numbers

  type :: boxes_t
    type(communicator_t) :: comm
    integer :: cells(3)                !< cells of the whole grid
    logical :: periodic(3)             !< whether opposite faces of the grid are joined
    integer :: ranks(3)                !< ranks in each direction
    integer :: place(3)                !< my place among them, from 0
    integer :: lo(3), hi(3)            !< first and last cell of my box, counted in the whole grid from 1
    integer :: n(3)                    !< cells of my box
    logical :: at_low(3), at_high(3)   !< whether my box touches a face of the domain that is not periodic
    integer :: neighbour(2, 3)         !< rank below and above in each direction, or -1; may be myself
    integer, allocatable :: first(:,:)  !< (0:ranks, 3) first cell of the boxes at each place
  contains
    procedure :: rank_at
    procedure :: owner_of
    procedure :: range_of
  end type boxes_t

contains

  !> Cut a grid of n cells into as many boxes as there are ranks; the cheapest cut is taken, see `cost`.
  subroutine new_boxes(comm, n, periodic, boxes, outcome)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    type(boxes_t), intent(out) :: boxes
    type(outcome_t), intent(inout) :: outcome

    boxes%comm = comm
    boxes%cells = n
    boxes%periodic = periodic
    call choose_ranks(comm%size, n, periodic, boxes%ranks)
    if (any(boxes%ranks == 0)) then
      call outcome%fail(exit_input, too_many(comm%size, n, periodic))
      return
    end if
    call place_box(boxes)
  end subroutine new_boxes

  !> Fill in everything that follows from the ranks in each direction.
  subroutine place_box(boxes)
    type(boxes_t), intent(inout) :: boxes

    integer :: a, step, there(3)

    associate (ranks => boxes%ranks, place => boxes%place)
      allocate (boxes%first(0:maxval(ranks), 3), source=0)
      place = [modulo(boxes%comm%rank, ranks(1)), modulo(boxes%comm%rank/ranks(1), ranks(2)), &
               boxes%comm%rank/(ranks(1)*ranks(2))]
      do a = 1, 3
        boxes%first(0:ranks(a), a) = cut(boxes%cells(a), ranks(a))
        boxes%lo(a) = boxes%first(place(a), a)
        boxes%hi(a) = boxes%first(place(a) + 1, a) - 1
        boxes%at_low(a) = place(a) == 0 .and. .not. boxes%periodic(a)
        boxes%at_high(a) = place(a) == ranks(a) - 1 .and. .not. boxes%periodic(a)
        do step = 1, 2
          there = place
          there(a) = place(a) + 2*step - 3
          boxes%neighbour(step, a) = boxes%rank_at(there)
        end do
      end do
    end associate
    boxes%n = boxes%hi - boxes%lo + 1
  end subroutine place_box

  !> The rank at a place; places beyond the grid wrap round where it is periodic and are -1 where it is not.
  pure function rank_at(self, place) result(rank)
    class(boxes_t), intent(in) :: self
    integer, intent(in) :: place(3)
    integer :: rank

    integer :: wrapped(3)

    wrapped = modulo(place, self%ranks)
    rank = wrapped(1) + self%ranks(1)*(wrapped(2) + self%ranks(2)*wrapped(3))
    if (any(wrapped /= place .and. .not. self%periodic)) rank = no_neighbour
  end function rank_at

  !> The rank whose box holds a cell of the whole grid.
  pure function owner_of(self, cell) result(rank)
    class(boxes_t), intent(in) :: self
    integer, intent(in) :: cell(3)
    integer :: rank

    integer :: a, place(3)

    do a = 1, 3
      place(a) = count(self%first(1:self%ranks(a) - 1, a) <= cell(a))
    end do
    rank = self%rank_at(place)
  end function owner_of

  !> The first and last cell of the box of any rank.
  pure subroutine range_of(self, rank, lo, hi)
    class(boxes_t), intent(in) :: self
    integer, intent(in) :: rank
    integer, intent(out) :: lo(3), hi(3)

    integer :: a, place(3)

    place = [modulo(rank, self%ranks(1)), modulo(rank/self%ranks(1), self%ranks(2)), &
             rank/(self%ranks(1)*self%ranks(2))]
    do a = 1, 3
      lo(a) = self%first(place(a), a)
      hi(a) = self%first(place(a) + 1, a) - 1
    end do
  end subroutine range_of

  !> The cheapest ranks(3) with the given product; 0 where there is none.
  !> Among equals the last directions are cut, because their faces are contiguous in memory.
  pure subroutine choose_ranks(size, n, periodic, ranks)
    integer, intent(in) :: size, n(3)
    logical, intent(in) :: periodic(3)
    integer, intent(out) :: ranks(3)

    integer :: i, j, trial(3)
    real(wp) :: lowest, price

    ranks = 0
    lowest = huge(1.0_wp)
    do i = 1, size
      if (modulo(size, i) /= 0) cycle
      do j = 1, size/i
        if (modulo(size/i, j) /= 0) cycle
        trial = [i, j, size/(i*j)]
        if (any(trial > 1 .and. n < thinnest*trial)) cycle
        price = cost(trial, n, periodic)
        if (price >= lowest) cycle
        lowest = price
        ranks = trial
      end do
    end do
  end subroutine choose_ranks

  !> What a cut costs: the cells of the largest box, and those it exchanges, two deep, with other ranks.
  pure function cost(ranks, n, periodic) result(price)
    integer, intent(in) :: ranks(3), n(3)
    logical, intent(in) :: periodic(3)
    real(wp) :: price

    integer :: a, widest(3), sides(3)

    do a = 1, 3
      associate (first => cut(n(a), ranks(a)))
        widest(a) = maxval(first(2:) - first(:ranks(a)))
      end associate
    end do
    sides = merge(2, merge(1, 0, ranks == 2), ranks > 2 .or. (periodic .and. ranks == 2))
    price = product(real(widest, wp))*(1 + sum(2*sides/real(widest, wp)))
  end function cost

  !> The first cells of `parts` nearly equal runs of n cells, and n + 1.
  !> Multigrid halves a box evenly when its size is even, so whole pairs of cells are dealt out if that keeps
  !> the runs nearly equal; an odd cell goes to the last run.
  pure function cut(n, parts) result(first)
    integer, intent(in) :: n, parts
    integer :: first(0:parts)

    integer :: pairs, p

    pairs = n/2
    first = [(1 + int(p*real(n, wp)/parts), p=0, parts)]
    if (pairs < parts .or. 2*((pairs + parts - 1)/parts) > uneven*n/parts) return
    first = [(1 + 2*int(p*real(pairs, wp)/parts), p=0, parts)]
    first(parts) = n + 1
  end function cut

  !> The message for more ranks than the grid can be cut into.
  pure function too_many(size, n, periodic) result(message)
    integer, intent(in) :: size, n(3)
    logical, intent(in) :: periodic(3)
    character(len=:), allocatable :: message

    character(len=160) :: text
    integer :: fewer, ranks(3)

    do fewer = size - 1, 1, -1
      call choose_ranks(fewer, n, periodic, ranks)
      if (all(ranks > 0)) exit
    end do
    write (text, '(5(i0,a))') size, ' ranks cannot share ', n(1), ' x ', n(2), ' x ', n(3), &
      ' gas cells in boxes of at least 2 cells along each cut: use at most ', fewer, ' ranks'
    message = trim(text)
  end function too_many

end module boxes
