!> What tiles mean as work: parcels, also near walls, pairs near each other, and pairs that touch.
! ranks: 1
program test_tile_work
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put
  use kinds, only: wp
  use solids, only: solids_t
  use tile_work, only: work_of_tiles
  implicit none

  real(wp), parameter :: d = 1.0e-3_wp, place(3) = [3.0e-3_wp, 5.0e-3_wp, 15.0e-3_wp], far(3) = [3.0e-3_wp, 5.0e-3_wp, 5.0e-3_wp], &
    corner(3) = [0.6e-3_wp, 5.0e-3_wp, 0.6e-3_wp]
  type(communicator_t) :: comm
  real(wp) :: apart, near, touching, at_walls

  call start_ranks(comm)
  apart = extra(5.0_wp, far)
  near = extra(1.02_wp, far)
  touching = extra(0.99_wp, far)
  at_walls = extra(5.0_wp, corner)
  call expect_close(apart, 0.0_wp, 1.0e-12_wp, 'parcels far from each other are one unit each')
  call expect(near > 0.05_wp .and. near < 0.5_wp, 'a pair that is listed is a part of one')
  call expect(touching > near + 1.0_wp .and. touching < 2.0_wp, 'a pair that touches is more')
  call expect(at_walls > 2.0_wp .and. at_walls < 3.0_wp, 'so is a parcel near walls, once for all of them')
  call finish()
  call stop_ranks()

contains

  !> What a pair so many diameters apart is beside its parcels, and a third one, alone in another tile, more than a unit.
  function extra(distance, third)
    real(wp), intent(in) :: distance
    real(wp), intent(in) :: third(3)  !< [m]
    real(wp) :: extra

    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 3)
    real(wp), allocatable :: work(:)

    contact%stiffness = 200.0_wp
    solids = scene(comm, [0.01_wp, 0.01_wp, 0.02_wp], 0.0_wp, contact)
    x = reshape([third, place, place + [distance*d, 0.0_wp, 0.0_wp]], [3, 3])
    call put(solids, x, 0*x, [d, d, d])
    work = work_of_tiles(solids%tiles, solids%parcels, solids%list, solids%walls%parcel(1:solids%walls%entries))
    extra = sum(work) - 3
    call expect_close(work(solids%tiles%tile_of(third)), 1 + merge(extra, 0.0_wp, third(1) < d), 1.0e-12_wp, &
                      'a parcel alone is one unit in its tile, more near walls')
  end function extra

end program test_tile_work
