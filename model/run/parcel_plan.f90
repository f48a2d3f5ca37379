!> What a case will make of its powders, known before a single parcel exists.
module parcel_plan
  use case, only: case_t
  use constants, only: is_set, pi
  use contact_law, only: contact_law_t, new_pair_law, new_wall_law
  use kinds, only: wp
  use outcome, only: outcome_t
  use quantiles, only: quantiles_t
  use size_distribution, only: size_distribution_t, new_size_distribution
  use weighting, only: weighting_t, new_weighting, sphere_volume
  implicit none
  private
  public :: parcel_plan_t, new_parcel_plan

  !> The parcels of one fill. A fill from a file has none of this.
  type :: parcel_plan_t
    logical :: known = .false.
    real(wp) :: parcels = 0            !< how many, to about one
    real(wp) :: volume = 0             !< of all its particles [m3]
    real(wp) :: means(3) = 0           !< number, mass and Sauter mean diameter of the powder [m]
    real(wp) :: particle(2) = 0        !< smallest and largest particle [m]
    real(wp) :: diameter(2) = 0        !< smallest and largest parcel [m]
    real(wp) :: weight(2) = 0          !< least and most particles in a parcel
    real(wp) :: mean_weight = 0        !< all particles over all parcels
    real(wp) :: contact_time = 0       !< of the shortest collision [s]
  end type parcel_plan_t

contains

  !> Fails where the powder of the fill, or the weighting, is not one.
  subroutine new_parcel_plan(case, fill, plan, outcome)
    type(case_t), intent(in) :: case
    integer, intent(in) :: fill   !< its place in case%fills
    type(parcel_plan_t), intent(out) :: plan
    type(outcome_t), intent(inout) :: outcome

    type(size_distribution_t) :: sizes
    type(weighting_t) :: weighting
    real(wp) :: parcel_volume

    associate (settings => case%fills(fill))
      if (settings%powder == 0 .or. .not. (is_set(settings%mass) .or. settings%number > 0)) return
      if (.not. is_set(case%powders(settings%powder)%density)) return
      call new_size_distribution(case%powders(settings%powder), sizes, outcome)
      call new_weighting(case%parcels, weighting, outcome)
      if (outcome%failed()) return
      ! Parcels of size d are drawn from d^(3 theta) p_N(d) and hold W(d) particles each.
      plan%mean_weight = weighting%weight_0*weighting%diameter_0**(3*weighting%theta)/sizes%moment(3*weighting%theta)
      parcel_volume = plan%mean_weight*sizes%moment(3.0_wp)*pi/6
      plan%means = [sizes%number_mean(), sizes%mass_mean(), sizes%sauter_mean()]
      plan%parcels = settings%number
      if (is_set(settings%mass)) plan%parcels = settings%mass/(case%powders(settings%powder)%density*parcel_volume)
      plan%volume = plan%parcels*parcel_volume
      call find_extremes(sizes%weighted_by(3*weighting%theta), weighting, plan)
      if (is_set(merge(case%contact%youngs_modulus, case%contact%stiffness, case%contact%law == 'hertz'))) then
        plan%contact_time = shortest_contact(case, case%powders(settings%powder)%density &
                                             *sphere_volume(plan%diameter(1)), plan%diameter(1)/2)
      end if
      plan%known = .true.
    end associate
  end subroutine new_parcel_plan

  !> The ends of the parcels' distribution, as far as so many parcels reach them.
  subroutine find_extremes(sizes, weighting, plan)
    type(quantiles_t), intent(in) :: sizes
    type(weighting_t), intent(in) :: weighting
    type(parcel_plan_t), intent(inout) :: plan

    real(wp) :: tail

    tail = min(0.5_wp, 0.5_wp/max(plan%parcels, 1.0_wp))
    plan%particle = [sizes%at(tail), sizes%at(1 - tail)]
    plan%diameter = weighting%collision_diameter(plan%particle)
    plan%weight = weighting%weight(plan%particle)
    plan%weight = [minval(plan%weight), maxval(plan%weight)]
  end subroutine find_extremes

  !> Of two of the smallest parcels, or of one and a wall; or the swing by their attraction [s].
  pure function shortest_contact(case, mass, radius) result(time)
    type(case_t), intent(in) :: case
    real(wp), intent(in) :: mass    !< of the smallest parcel [kg]
    real(wp), intent(in) :: radius  !< of it [m]
    real(wp) :: time

    type(contact_law_t) :: pair, wall

    pair = new_pair_law(case%contact)
    wall = new_wall_law(case%contact)
    time = min(pair%contact_time(mass/2, radius/2, case%contact%impact_velocity), &
               wall%contact_time(mass, radius, case%contact%impact_velocity), &
               pair%cohesion%time(radius/mass), wall%cohesion%time(radius/mass))
  end function shortest_contact

end module parcel_plan
