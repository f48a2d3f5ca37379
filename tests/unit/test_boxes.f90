!> The cut of the gas grid into boxes: complete, fair, and refused when it cannot be.
program test_boxes
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  implicit none

  type(communicator_t) :: comm, many
  type(boxes_t) :: cut
  type(outcome_t) :: outcome
  logical, parameter :: never(3) = .false.

  call start_ranks(comm)
  call cover([40, 10, 200], [.false., .false., .false.], 'a bed')
  call cover([9, 7, 5], [.true., .true., .true.], 'an odd periodic grid')
  call cover([16, 16, 1], [.false., .false., .true.], 'a flat grid')
  call expect_root(product(cut%ranks) == comm%size .and. cut%ranks(3) == 1, 'one layer of cells is not cut')

  many = comm
  many%rank = 5
  many%size = 8
  call new_boxes(many, [20, 10, 200], never, cut, outcome)
  call expect_root(all(cut%ranks == [1, 1, 8]), 'a tall bed is cut along its height')
  call new_boxes(many, [32, 32, 32], never, cut, outcome)
  call expect_root(all(cut%ranks == [2, 2, 2]), 'a cube is cut into cubes')
  call expect_root(all(cut%neighbour == reshape([4, -1, -1, 7, 1, -1], [2, 3])), 'neighbours of place (1,0,1)')
  call expect_root(all(cut%at_high .eqv. [.true., .false., .true.]), 'faces touched by place (1,0,1)')
  many%rank = 3
  call new_boxes(many, [2, 1, 100], [.true., .true., .false.], cut, outcome)
  call expect_root(all(cut%neighbour(:, 1:2) == 3), 'a periodic direction that is not cut joins a box to itself')
  call expect_root(all(modulo(cut%first(1:7, 3), 2) == 1), 'boxes are of even size')
  many%size = 2
  many%rank = 0
  call new_boxes(many, [1, 1, 5], never, cut, outcome)
  call expect_root(all(cut%first(1:2, 3) == [3, 6]), 'an odd cell goes to the last box')
  call new_boxes(many, [1, 1, 10], never, cut, outcome)
  call expect_root(all(cut%first(1:2, 3) == [5, 11]) .or. all(cut%first(1:2, 3) == [6, 11]), 'ten cells on two ranks')
  call expect_root(.not. outcome%failed(), 'none of these fails')

  many%size = 64
  call new_boxes(many, [4, 7, 3], never, cut, outcome)
  call expect_root(outcome%code == exit_input, 'more ranks than cells allow are a mistake of the user')
  if (comm%is_root()) print '(2a)', '     ', outcome%message
  call expect_root(index(outcome%message, 'at most 6 ranks') > 0, 'and told how many they may be')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Every cell of a grid belongs to exactly one box, and boxes differ little.
  subroutine cover(n, periodic, name)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(outcome_t) :: result
    integer :: i, j, k, mine, lo(3), hi(3), rank, volume
    logical :: right

    call new_boxes(comm, n, periodic, cut, result)
    right = .not. result%failed()
    mine = 0
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          if (cut%owner_of([i, j, k]) /= comm%rank) cycle
          mine = mine + 1
          right = right .and. all([i, j, k] >= cut%lo .and. [i, j, k] <= cut%hi)
        end do
      end do
    end do
    right = right .and. mine == product(cut%n)
    volume = 0
    do rank = 0, comm%size - 1
      call cut%range_of(rank, lo, hi)
      volume = volume + product(hi - lo + 1)
    end do
    call expect_root(.not. comm%any_of(.not. right .or. volume /= product(n)), 'boxes of '//name//' hold all cells once')
    call expect_root(comm%max(mine) <= 1.5_wp*product(n)/comm%size, 'boxes of '//name//' are of one size')
  end subroutine cover

  subroutine expect_root(ok, name)
    logical, intent(in) :: ok
    character(len=*), intent(in) :: name

    if (comm%is_root()) call expect(ok, name)
  end subroutine expect_root

end program test_boxes
