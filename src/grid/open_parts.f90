!> The parts of the gas's space: cells that a way through open faces connects.
module open_parts
  use boxes, only: boxes_t
  use halo, only: halo_t, new_halo
  use kinds, only: wp, i8
  use open_space, only: open_space_t
  use sorting, only: ascending
  implicit none
  private
  public :: open_parts_t, find_parts

  real(wp), parameter :: none = huge(1.0_wp)  !< the number of a closed cell

  !> The same on any number of ranks.
  type :: open_parts_t
    integer :: n = 0                       !< parts
    integer, allocatable :: part(:,:,:)    !< (-1:n1+2,...) of each cell of my box and its halo, from 1; 0 of closed ones
    integer, allocatable :: first(:,:)     !< (3,n) the first cell of each in the whole grid
  end type open_parts_t

contains

  !> All ranks together. A cell takes the least number of those its open faces connect it with until none changes.
  subroutine find_parts(boxes, space, parts)
    type(boxes_t), intent(in) :: boxes
    type(open_space_t), intent(in) :: space
    type(open_parts_t), intent(out) :: parts

    type(halo_t) :: halo
    real(wp), allocatable :: number(:,:,:), own(:,:,:)
    logical :: changed

    halo = new_halo(boxes)
    allocate (number, mold=space%volume)
    number = none
    call number_cells(boxes, space, number)
    allocate (own, source=number)
    do
      call halo%exchange(number)
      call spread_least(boxes%n, space%area, number, changed)
      if (.not. boxes%comm%any_of(changed)) exit
    end do
    call list_parts(boxes, own, number, parts)
  end subroutine find_parts

  !> Open cells by their place in the whole grid, from 0.
  pure subroutine number_cells(boxes, space, number)
    type(boxes_t), intent(in) :: boxes
    type(open_space_t), intent(in) :: space
    real(wp), intent(inout) :: number(-1:, -1:, -1:)

    integer :: i, j, k

    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          if (space%closed(i, j, k)) cycle
          associate (cell => boxes%lo + [i, j, k] - 2, cells => real(boxes%cells, wp))
            number(i, j, k) = cell(1) + cells(1)*(cell(2) + cells(2)*cell(3))
          end associate
        end do
      end do
    end do
  end subroutine number_cells

  !> Within my box, back and forth until nothing changes.
  pure subroutine spread_least(n, area, number, changed)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: area(-1:, -1:, -1:, :)
    real(wp), intent(inout) :: number(-1:, -1:, -1:)
    logical, intent(out) :: changed  !< whether anything did

    real(wp) :: least
    integer :: i, j, k, way
    logical :: again

    changed = .false.
    again = .true.
    do while (again)
      again = .false.
      do way = 1, -1, -2
        do k = merge(1, n(3), way > 0), merge(n(3), 1, way > 0), way
          do j = merge(1, n(2), way > 0), merge(n(2), 1, way > 0), way
            do i = merge(1, n(1), way > 0), merge(n(1), 1, way > 0), way
              if (.not. number(i, j, k) < none) cycle
              least = min(number(i, j, k), &
                          merge(number(i - 1, j, k), none, area(i - 1, j, k, 1) > 0.0_wp), &
                          merge(number(i + 1, j, k), none, area(i, j, k, 1) > 0.0_wp), &
                          merge(number(i, j - 1, k), none, area(i, j - 1, k, 2) > 0.0_wp), &
                          merge(number(i, j + 1, k), none, area(i, j, k, 2) > 0.0_wp), &
                          merge(number(i, j, k - 1), none, area(i, j, k - 1, 3) > 0.0_wp), &
                          merge(number(i, j, k + 1), none, area(i, j, k, 3) > 0.0_wp))
              if (.not. least < number(i, j, k)) cycle
              number(i, j, k) = least
              again = .true.
              changed = .true.
            end do
          end do
        end do
      end do
    end do
  end subroutine spread_least

  !> Parts in the order of their first cells.
  subroutine list_parts(boxes, own, number, parts)
    type(boxes_t), intent(in) :: boxes
    real(wp), intent(in) :: own(-1:, -1:, -1:)     !< numbers of cells
    real(wp), intent(in) :: number(-1:, -1:, -1:)  !< and of the first of their parts
    type(open_parts_t), intent(inout) :: parts

    real(wp), allocatable :: firsts(:), mine(:)
    integer :: before, i, j, k, p

    associate (n => boxes%n)
      mine = pack(own(1:n(1), 1:n(2), 1:n(3)), own(1:n(1), 1:n(2), 1:n(3)) < none .and. &
                  .not. own(1:n(1), 1:n(2), 1:n(3)) > number(1:n(1), 1:n(2), 1:n(3)))
    end associate
    before = int(boxes%comm%before(int(size(mine), i8)))
    parts%n = int(boxes%comm%sum(int(size(mine), i8)))
    allocate (firsts(parts%n), source=0.0_wp)
    firsts(before + 1:before + size(mine)) = mine
    firsts = boxes%comm%sum(firsts)
    firsts = firsts(ascending(firsts))
    allocate (parts%part(-1:ubound(number, 1), -1:ubound(number, 2), -1:ubound(number, 3)), source=0)
    do k = -1, ubound(number, 3)
      do j = -1, ubound(number, 2)
        do i = -1, ubound(number, 1)
          if (number(i, j, k) < none) parts%part(i, j, k) = place_in(firsts, number(i, j, k))
        end do
      end do
    end do
    allocate (parts%first(3, parts%n))
    do p = 1, parts%n
      associate (cells => real(boxes%cells, wp))
        parts%first(1, p) = 1 + nint(modulo(firsts(p), cells(1)))
        parts%first(2, p) = 1 + int(modulo((firsts(p) + 0.5_wp)/cells(1), cells(2)))
        parts%first(3, p) = 1 + int((firsts(p) + 0.5_wp)/(cells(1)*cells(2)))
      end associate
    end do
  end subroutine list_parts

  !> Where a number is among others in ascending order.
  pure function place_in(sorted, x) result(place)
    real(wp), intent(in) :: sorted(:), x
    integer :: place

    integer :: high, middle

    place = 1
    high = size(sorted)
    do while (place < high)
      middle = (place + high + 1)/2
      if (sorted(middle) > x) high = middle - 1
      if (.not. sorted(middle) > x) place = middle
    end do
  end function place_in

end module open_parts
